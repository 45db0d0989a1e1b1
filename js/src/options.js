// Lists the options of each function: their names, their JavaScript types, and the words of the command line that they
// become. The program itself checks the words and the ranges of numbers. types/index.d.ts has the same list for
// compilers.
import { ChronormalError } from './error.js';

const USAGE = 2; // the exit code of the program for a wrong call

// The kinds of values that options have. Each kind is a test of a value, and the text that describes the kind in
// messages.
const isText = (value) => typeof value === 'string';
const NUMBER = [(value) => typeof value === 'number' && Number.isFinite(value), 'a finite number'];
const FLAG = [(value) => typeof value === 'boolean', 'true or false'];
const TEXT = [isText, 'a string'];
const isWord = (value) => isText(value) && value !== '';
const LIST = [(value) => isWord(value) || (Array.isArray(value) && value.length > 0 && value.every(isWord)), 'a word, or an array of words'];
const isNumber = (text) => text.trim() !== '' && Number.isFinite(Number(text));
const RANGE = [(value) => isText(value) && value.split(':').length === 2 && value.split(':').every(isNumber), "two numbers, such as '-1:1'"];
const NAME = [(value) => isText(value) || NUMBER[0](value), 'a string or a number'];
const WORD = [isWord, 'a word'];
const isNumbers = (value) => Array.isArray(value) && value.length > 0 && value.every(NUMBER[0]);
const TIMES = [(value) => isText(value) || NUMBER[0](value) || isNumbers(value), "a number, an array of numbers, or a string such as '0:0.1:2'"];
const isPoses = (value) => Array.isArray(value) && value.length > 0 && value.every(isNumbers);
const WEIGHTS = [(value) => isText(value) || isNumbers(value) || isPoses(value), 'an array of numbers, an array of such arrays, or a string'];

// The options of the JavaScript functions themselves, which are not passed to the program.
const isObject = (value) => typeof value === 'object' && value !== null;
const isBytes = (value) => value instanceof ArrayBuffer || ArrayBuffer.isView(value);
const CALL = {
  name: TEXT,
  resources: [(value) => isObject(value) && Object.values(value).every(isBytes), 'an object whose keys are names of files and whose values are their bytes (ArrayBuffer or Uint8Array)'],
  signal: [(value) => isObject(value) && typeof value.throwIfAborted === 'function', 'an AbortSignal'],
  onProgress: [(value) => typeof value === 'function', 'a function'],
  worker: FLAG,
  memoryLimit: NUMBER,
};

const READ = { allowExternal: FLAG, maxExpansion: NUMBER, fps: NUMBER, from: NUMBER, to: NUMBER, every: NUMBER, loop: FLAG, strict: FLAG, path: TEXT };
const MESHES = { base: TEXT, animation: NAME };

const OPTIONS = {
  audit: {
    ...READ, ...MESHES, rule: TEXT, weighting: TEXT, for: LIST, host: LIST, samples: NUMBER, poses: TEXT, weights: RANGE,
    tolerance: NUMBER, tears: NUMBER, noWeld: FLAG,
  },
  bake: {
    ...READ, for: LIST, encode: TEXT, weighting: TEXT, crease: NUMBER, recomputeBase: FLAG, smooth: FLAG, maxBytes: NUMBER,
    maxTargets: NUMBER, animationsOnly: FLAG, poses: TEXT, plan: FLAG, denseZeros: FLAG, tolerance: NUMBER, noWeld: FLAG, noAudit: FLAG,
  },
  compare: {
    ...READ, ...MESHES, world: FLAG, schemes: LIST, samples: NUMBER, elements: TEXT, crease: NUMBER, noWeld: FLAG, access: TEXT,
    weighting: TEXT, certify: FLAG, tolerance: NUMBER, face: NAME, blend: NUMBER, active: NUMBER, seed: NUMBER, truth: NUMBER, noTimes: FLAG,
  },
  inspect: { ...READ, ...MESHES, world: FLAG },
  sample: {
    ...READ, ...MESHES, world: FLAG, times: TIMES, weights: WEIGHTS, scheme: WORD, step: NUMBER, elements: TEXT, crease: NUMBER, hardEdges: WORD,
    noWeld: FLAG, weighting: TEXT, length: TEXT,
  },
};

const flagOf = (name) => `--${name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`)}`;

// Returns the number of letters that have to be changed, added or removed to turn one name into the other.
function distance(a, b) {
  let row = Array.from({ length: b.length + 1 }, (_, j) => j);
  for (let i = 1; i <= a.length; ++i) {
    const next = [i];
    for (let j = 1; j <= b.length; ++j) next[j] = Math.min(next[j - 1] + 1, row[j] + 1, row[j - 1] + (a[i - 1] === b[j - 1] ? 0 : 1));
    row = next;
  }
  return row.at(-1);
}

function refuseName(name, command, known) {
  const far = (other) => distance(name.toLowerCase(), other.toLowerCase()), [nearest] = Object.keys(known).sort((a, b) => far(a) - far(b));
  const hint = far(nearest) <= Math.max(1, name.length / 3) ? `did you mean ${nearest}?` : `choose one of ${Object.keys(known).sort().join(', ')}`;
  throw new ChronormalError(USAGE, `${command}() has no option ${JSON.stringify(name)}; ${hint}`);
}

/**
 * Returns the words of the command line for the options of a call.
 * @throws {ChronormalError} code 2 if an option has an unknown name
 * @throws {TypeError} if a value is of another kind than its option demands
 */
export function flagsOf(command, options) {
  if (!isObject(options)) throw new TypeError('options: the value must be an object');
  const known = { ...CALL, ...OPTIONS[command] }, flags = [];
  for (const [name, value] of Object.entries(options)) {
    if (!Object.hasOwn(known, name)) refuseName(name, command, known);
    if (value === undefined) continue;
    const [isRight, what] = known[name];
    if (!isRight(value)) throw new TypeError(`${name}: the value must be ${what}`);
    if (Object.hasOwn(CALL, name) || value === false) continue;
    // An array of arrays repeats the option, for example --weights for several poses.
    for (const each of isPoses(value) ? value : [value]) {
      flags.push(flagOf(name));
      if (each !== true) flags.push(Array.isArray(each) ? each.join(',') : String(each));
    }
  }
  return flags;
}
