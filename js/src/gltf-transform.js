// Defines a transform of glTF-Transform that bakes: await document.transform(chronormal({ for: ['three', 'godot'] })).
import { WebIO } from '@gltf-transform/core';
import { cloneDocument } from '@gltf-transform/functions';
import { bake } from 'chronormal';

// The extensions for compression that are removed from a document before a bake, since writing them would need
// encoders. Reading the file has already decompressed the data, so the result is not compressed.
const COMPRESSIONS = new Set(['KHR_draco_mesh_compression', 'EXT_meshopt_compression']);

async function bytesOf(document) {
  const plain = cloneDocument(document);
  for (const extension of plain.getRoot().listExtensionsUsed()) {
    if (COMPRESSIONS.has(extension.extensionName)) extension.dispose();
  }
  const io = new WebIO().registerExtensions(plain.getRoot().listExtensionsUsed().map((e) => e.constructor));
  return { io, bytes: await io.writeBinary(plain) };
}

// Copies the changes of a bake from one document into another document that is otherwise equal. The changes are
// normals, correction targets, weights, their tracks, and extras. All other objects stay the same.
class Transfer {
  constructor(document) {
    this.document = document;
    this.root = document.getRoot();
    this.buffer = this.root.listBuffers()[0] ?? document.createBuffer();
    this.copies = new Map();
  }

  accessor(from) {
    if (!from) return null;
    if (!this.copies.has(from)) {
      const copy = this.document.createAccessor(from.getName()).setType(from.getType()).setArray(from.getArray().slice());
      copy.setNormalized(from.getNormalized()).setSparse(from.getSparse()).setBuffer(this.buffer);
      this.copies.set(from, copy);
    }
    return this.copies.get(from);
  }

  attribute(to, from, semantic) {
    const before = to.getAttribute(semantic), after = from.getAttribute(semantic);
    if (!same(before, after)) to.setAttribute(semantic, this.accessor(after));
  }

  primitive(to, from) {
    this.attribute(to, from, 'NORMAL');
    const before = to.listTargets();
    from.listTargets().forEach((target, i) => {
      if (i < before.length) return this.attribute(before[i], target, 'NORMAL');
      const extra = this.document.createPrimitiveTarget(target.getName());
      for (const semantic of target.listSemantics()) {
        extra.setAttribute(semantic, this.accessor(target.getAttribute(semantic)));
      }
      return to.addTarget(extra);
    });
  }

  animation(to, from) {
    const samplers = new Map();
    from.listChannels().forEach((channel, c) => {
      const old = to.listChannels()[c].getSampler(), made = channel.getSampler();
      if (channel.getTargetPath() !== 'weights' || (same(old.getInput(), made.getInput()) && same(old.getOutput(), made.getOutput()))) return;
      if (!samplers.has(made)) {
        const copy = this.document.createAnimationSampler(made.getName()).setInterpolation(made.getInterpolation());
        copy.setInput(this.accessor(made.getInput())).setOutput(this.accessor(made.getOutput()));
        to.addSampler(copy);
        samplers.set(made, copy);
      }
      to.listChannels()[c].setSampler(samplers.get(made));
    });
    for (const sampler of to.listSamplers()) {
      if (!to.listChannels().some((channel) => channel.getSampler() === sampler)) sampler.dispose();
    }
  }

  all(baked) {
    const pairs = (list) => list(this.root).map((to, n) => [to, list(baked.getRoot())[n]]);
    for (const [to, from] of pairs((root) => root.listMeshes())) {
      to.listPrimitives().forEach((primitive, p) => this.primitive(primitive, from.listPrimitives()[p]));
      to.setWeights(from.getWeights()).setExtras(from.getExtras());
    }
    for (const [to, from] of pairs((root) => root.listNodes())) to.setWeights(from.getWeights()).setExtras(from.getExtras());
    for (const [to, from] of pairs((root) => root.listAnimations())) this.animation(to, from);
    for (const accessor of this.root.listAccessors()) {
      if (accessor.listParents().every(({ propertyType }) => propertyType === 'Root')) accessor.dispose();
    }
  }
}

function same(a, b) {
  if (!a || !b) return a === b;
  const x = a.getArray(), y = b.getArray();
  return x.constructor === y.constructor && x.length === y.length && x.every((value, n) => value === y[n]);
}

/**
 * Returns a transform that bakes a document in place. The options are those of bake(). The report is passed to
 * options.onReport, and warnings to the logger of the document.
 */
export function chronormal({ onReport, ...options } = {}) {
  for (const name of ['name', 'resources', 'plan']) {
    if (Object.hasOwn(options, name)) throw new TypeError(`${name}: this option is only for bake(), not for a transform`);
  }
  const transform = async (document) => {
    const { io, bytes } = await bytesOf(document);
    const result = await bake(bytes, options);
    new Transfer(document).all(await io.readBinary(result.bytes));
    for (const warning of result.warnings) document.getLogger().warn(warning);
    onReport?.(result.report);
  };
  return Object.defineProperty(transform, 'name', { value: 'chronormal' });
}

// The options of the program that command() below offers. Each entry has the name, the spelling, the help, and a
// function that converts the text to a value.
const OPTIONS = [
  ['for', '--for <VIEWERS>', 'make the result for these viewers, such as three,godot, or for all (default: three, babylon, playcanvas and bevy)'],
  ['tolerance', '--tolerance <DEGREES>', 'set the largest error allowed, in degrees (default: 0.5, and 0.001 with exact)', Number],
  ['encode', '--encode <HOW>', 'choose how new normals are stored: smallest (default), harmless, exact or endpoint'],
  ['weighting', '--weighting <RULE>', 'choose how much each face counts in a vertex normal (default: as in the base normals)'],
  ['maxTargets', '--max-targets <N>', 'write at most N morph targets for each mesh (default: as many as viewers can show)', Number],
  ['maxBytes', '--max-bytes <N>', 'spend at most N bytes on the normals of each mesh', Number],
  ['animationsOnly', '--animations-only', 'correct only the animations, not single sliders (weights of one target)'],
];

/**
 * Adds the command `gltf-transform chronormal IN OUT` to the command line of glTF-Transform. Use this function as
 * onProgramReady in a gltf-transform.config.mjs.
 */
export function command({ program, io, Session }) {
  const made = program
    .command('chronormal', 'Correct the normals of morph targets')
    .help('Corrects the normals of meshes that morph targets move. `npx chronormal bake --help` explains the options.')
    .argument('<input>', 'The glTF 2.0 model to read (.glb, .gltf)')
    .argument('<output>', 'The file to write');
  for (const [, written, said] of OPTIONS) made.option(written, said);
  made.action(({ args, options, logger }) => {
    const valueOf = (text, read) => (text === undefined ? undefined : read ? read(text) : text);
    const given = Object.fromEntries(OPTIONS.map(([name, , , read]) => [name, valueOf(options[name], read)]));
    return Session.create(io, logger, args.input, args.output).transform(chronormal(given));
  });
}
