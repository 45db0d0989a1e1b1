// Holds the state of the picture: the part, the motion, the place in the motion (or weights that were set by hand), the
// viewer, and the scheme.
import { drive, formulasOf } from '../../js/src/drive.js';
import { makeSequence } from './sequence.js';
import { SCHEMES } from './schemes.js';
import { makeSurface, weightsAt } from './surface.js';
import { neighbour, placeOf, segmentAt, valueAt, worstSample } from './motions.js';

const TOUR = 3; // seconds for which a motion without times plays

/**
 * Makes a player.
 * @param report from readContainer()
 * @param {(what: 'part' | 'motion' | 'step' | 'viewer' | 'play') => void} onChange is called with the kind of each
 *   change. A change of the part also changes the motion, and a change of the motion also makes a step
 */
export function makePlayer(report, onChange) {
  const surfaces = new Map();
  const player = { report, at: 0, viewer: 'specification', scheme: 'linear', byHand: false, isPlaying: false };
  const isGltf = report.kind === 'gltf';

  function pose() {
    const { part, motion, surface, weights } = player;
    if (!isGltf) {
      surface.pose(...segmentAt(motion, player.at), player.scheme, motion.least);
    } else if (player.byHand) {
      drive(player.formulas, weights);
      surface.pose(weights, player.viewer, null);
    } else {
      if (motion) weightsAt(motion, player.viewer, player.at, weights);
      surface.pose(weights, player.viewer, motion?.least);
    }
    let worst = -1;
    const { degrees } = surface;
    for (let v = 0; v < part.vertices; ++v) if (worst < 0 ? degrees[v] >= 0 : degrees[v] > degrees[worst]) worst = v;
    player.worst = worst;
  }
  const step = () => {
    pose();
    onChange('step');
  };

  player.choosePart = (index) => {
    const part = report.parts[index];
    if (!surfaces.has(index)) surfaces.set(index, isGltf ? makeSurface(part) : makeSequence(part));
    Object.assign(player, { index, part, surface: surfaces.get(index), byHand: false });
    if (isGltf) {
      player.weights = new Float64Array(part.targets.length);
      player.formulas = formulasOf(part.mark, part.targets.length);
      player.viewers = part.shown.flatMap(({ viewers }) => viewers);
      if (!player.viewers.includes(player.viewer)) player.viewer = 'specification';
    } else {
      player.viewers = [];
    }
    onChange('part');
    const worst = part.motions.reduce((best, motion, i) => (motion.worst[worstSample(motion)] > part.motions[best].worst[worstSample(part.motions[best])] ? i : best), 0);
    player.chooseMotion(worst);
  };
  player.chooseMotion = (number, at) => {
    const motion = player.part.motions[number];
    Object.assign(player, { motion, motionNumber: number, byHand: false, at: motion ? at ?? worstSample(motion) : 0 });
    onChange('motion');
    step();
  };
  /** Goes to one of the worst places of the report, and returns its vertex. */
  player.visit = ({ part, motion, sample, vertex }) => {
    player.pause();
    if (player.viewer !== 'specification') player.chooseViewer('specification');
    if (player.scheme !== 'linear') player.chooseScheme('linear');
    if (part !== player.index) player.choosePart(part);
    player.chooseMotion(motion, sample);
    return vertex;
  };
  player.go = (at) => {
    if (!player.motion) return;
    Object.assign(player, { at, byHand: false });
    step();
  };
  player.goTo = (value) => player.go(placeOf(player.motion, value));
  player.step = (steps) => {
    let { at } = player;
    for (let i = 0; i < Math.abs(steps); ++i) at = neighbour(player.motion, at, Math.sign(steps));
    player.go(at);
  };
  player.value = () => (player.motion ? valueAt(player.motion, player.at) : 0);
  player.setWeight = (target, weight) => {
    player.pause();
    player.byHand = true;
    player.weights[target] = weight;
    step();
  };
  player.rest = () => {
    player.pause();
    player.byHand = true;
    player.weights.fill(0);
    step();
  };
  player.chooseViewer = (viewer) => {
    player.viewer = viewer;
    step();
    onChange('viewer');
  };
  player.chooseScheme = (scheme) => {
    player.scheme = scheme;
    step();
    onChange('viewer');
  };
  player.schemes = () => (isGltf ? [] : Object.keys(SCHEMES));

  player.pause = () => {
    player.isPlaying = false;
    onChange('play');
  };
  player.play = () => {
    const { motion } = player;
    if (!motion || motion.at.length < 2) return;
    player.isPlaying = true;
    player.byHand = false;
    onChange('play');
    const first = motion.at[0], length = motion.at[motion.at.length - 1] - first;
    let last = performance.now();
    const frame = (now) => {
      if (!player.isPlaying || player.motion !== motion) return;
      const seconds = (now - last) / 1000, passed = motion.seconds ? seconds : (seconds * length) / TOUR;
      last = now;
      const value = player.value() + passed;
      player.goTo(value > first + length ? first + ((value - first) % (length || 1)) : value);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  };
  player.toggle = () => (player.isPlaying ? player.pause() : player.play());
  return player;
}
