// Makes require() fail with a helpful message on versions of Node.js whose require() cannot load ES modules. The
// package has no second build for CommonJS (see the README).
throw new Error(
  "chronormal is a package of ES modules, which require() loads from Node.js 20.19 and 22.12 on; this Node.js is " + process.versions.node +
    ". Use import { bake } from 'chronormal' in a module, or const { bake } = await import('chronormal') anywhere",
);
