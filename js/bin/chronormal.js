#!/usr/bin/env node
// Runs the program on any system with Node.js, on the files of this machine. Commands, messages and exit codes are
// those of the native program. An older version of Node.js must be able to parse this file and report the version that
// it needs, so import and await occur only inside functions.
const LEAST = 18; // the smallest version in "engines" of package.json

if (parseInt(process.versions.node, 10) < LEAST) {
  console.error(`chronormal: this program needs Node.js ${LEAST} or later, and this is ${process.versions.node}; install a newer version`);
  process.exitCode = 1;
} else {
  import('../src/cli.js')
    .then(({ main }) => main(process.argv.slice(2)))
    .catch(({ message }) => {
      console.error(`chronormal: ${message}`);
      return 1;
    })
    .then((code) => { process.exitCode = code; });
}
