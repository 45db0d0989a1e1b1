// Counts the places where the product makes an error, and those that no test has reached. A part of `./test --full clang`,
// whose build counts how often every region of the source runs (clang's source-based coverage).
//
//   node tools/error_sites.mjs COVERAGE.json ROOT      COVERAGE.json is what `llvm-cov export` printed
//
// An error site is where an Error is made, directly or by a function that returns one. tests/unreached_errors.txt names
// those that no test can reach, each with the reason. It fails where another one is not reached, and where one of that
// list is, so that the list stays true.
import { readFileSync } from 'node:fs';
import { join, relative } from 'node:path';

const [coverage, root] = process.argv.slice(2);
const files = JSON.parse(readFileSync(coverage, 'utf8')).data[0].files.filter(({ filename }) =>
  /^(src|cli|include)\//.test(relative(root, filename)),
);

// "path: line of source   # why" by line, as the file has it.
const listed = new Map(
  readFileSync(join(root, 'tests/unreached_errors.txt'), 'utf8')
    .split('\n')
    .filter((line) => line && !line.startsWith('#'))
    .map((line) => [line.split('   # ')[0], false]),
);

// The names of functions, members and lambdas of a file that make errors.
function makersOf(text) {
  const names = ['invalid_input'];
  for (const [, name] of text.matchAll(/^\s*(?:\[\[nodiscard\]\] )?(?:inline )?Error (\w+)\(/gm)) names.push(name);
  for (const [, name] of text.matchAll(/auto (\w+) = \[[^;]*?\b(?:Error\{|invalid_input\(|misuse\()/g)) names.push(name);
  return names;
}

// How often the source runs at a place: a segment of the coverage reaches from its line and column to the next one.
function countAt(segments, line, column) {
  let count;
  for (const [l, c, n, hasCount] of segments) {
    if (l > line || (l === line && c > column)) break;
    count = hasCount ? n : undefined;
  }
  return count;
}

const everyMaker = new Set();
const texts = new Map(files.map(({ filename }) => [filename, readFileSync(filename, 'utf8')]));
for (const text of texts.values()) makersOf(text).forEach((name) => everyMaker.add(name));

let sites = 0;
const unreached = [];
for (const { filename, segments } of files) {
  const path = relative(root, filename);
  const site = new RegExp(`(?<!Error )(?<![\\w.:>])(?:Error\\{|(?:${[...everyMaker].join('|')})\\()`, 'g');
  texts
    .get(filename)
    .split('\n')
    .forEach((line, index) => {
      if (/^\s*(\/\/|const auto \w+ = \[)/.test(line) || /^\s*(\[\[nodiscard\]\] )?(inline )?Error \w+\(/.test(line)) return;
      for (const { index: column } of line.matchAll(site)) {
        const count = countAt(segments, index + 1, column + 1);
        if (count === undefined) continue;
        ++sites;
        const key = `${path}: ${line.trim()}`;
        if (count === 0 && !listed.has(key)) unreached.push(`${path}:${index + 1}: ${line.trim()}`);
        if (listed.has(key)) listed.set(key, listed.get(key) || count === 0);
      }
    });
}

const stale = [...listed].filter(([, isUnreached]) => !isUnreached).map(([key]) => key);
console.log(`error sites: ${sites}, of which tests reach all but ${unreached.length + listed.size - stale.length}`);
for (const place of unreached) console.log(`not reached: ${place}`);
for (const key of stale) console.log(`reached, or gone, so that tests/unreached_errors.txt must not name it: ${key}`);
process.exitCode = unreached.length + stale.length > 0 || sites === 0 ? 1 : 0;
