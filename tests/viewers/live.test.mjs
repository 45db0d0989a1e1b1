// Tests when chronormal/three and chronormal/babylon set the weights of correction targets, on which meshes, and when
// they stop. viewers.test.mjs tests the pixels that are drawn with these weights.
import assert from 'node:assert/strict';
import { describe, test } from 'node:test';
import { NullEngine } from '@babylonjs/core/Engines/nullEngine.js';
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Animation } from '@babylonjs/core/Animations/animation.js';
import { AnimationGroup } from '@babylonjs/core/Animations/animationGroup.js';
import { AssetContainer } from '@babylonjs/core/assetContainer.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import '@babylonjs/core/Meshes/instancedMesh.js';
import { CreateBox } from '@babylonjs/core/Meshes/Builders/boxBuilder.js';
import { MorphTarget } from '@babylonjs/core/Morph/morphTarget.js';
import { MorphTargetManager } from '@babylonjs/core/Morph/morphTargetManager.js';
import { Scene } from '@babylonjs/core/scene.js';
import * as THREE from 'three';
import { clone as cloneWithSkeletons } from 'three/addons/utils/SkeletonUtils.js';
import * as babylon from '../../js/src/babylon.js';
import { drive, formulasOf } from '../../js/src/drive.js';
import * as playcanvas from '../../js/src/playcanvas.js';
import * as three from '../../js/src/three.js';

// Returns what a bake writes into the extras of a mesh. Targets 0 and 1 are the author's. Targets 2 and 3 have the
// weights w0 w1 and w0 (1 - w0). Only animations drive target 4.
const mark = () => ({
  chronormal: {
    version: 2,
    encode: 'exact',
    sequence: false,
    extras: [
      { target: 2, linear: [], quadratic: [[0, 1, 1]] },
      { target: 3, linear: [[0, 1]], quadratic: [[0, 0, -1]] },
      { target: 4, linear: [], quadratic: [] },
    ],
  },
});
const TARGETS = 5;
const SET = [0.5, 0.25];
const DRIVEN = [0.5, 0.25, 0.125, 0.25, 0];

test('extra weights are the sums of their terms, and other versions are left alone', () => {
  const w = Float64Array.from([0.5, 0.25, 9, 9, 9]);
  drive(formulasOf(mark().chronormal, TARGETS), w);
  assert.deepEqual([...w], [0.5, 0.25, 0.125, 0.25, 9]);
  for (const other of [undefined, {}, { ...mark().chronormal, version: 3 }, { version: 2 }]) assert.deepEqual(formulasOf(other, TARGETS), []);
});

describe('three.js', () => {
  // Makes a mesh as the loader of three.js does: `userData` has the extras of the mesh in the file. If `userData` has
  // no data of a bake, the parent object may have these data.
  function meshOf(userData) {
    const geometry = new THREE.BoxGeometry();
    geometry.morphTargetsRelative = true;
    geometry.morphAttributes.position = Array.from({ length: TARGETS }, () => geometry.attributes.position.clone());
    const mesh = new THREE.Mesh(geometry, new THREE.MeshNormalMaterial());
    mesh.name = 'face';
    mesh.userData = userData;
    return mesh;
  }
  const set = (mesh, weights = SET) => weights.forEach((weight, i) => (mesh.morphTargetInfluences[i] = weight));
  const draw = (mesh) => mesh.onBeforeRender(null, null, null, mesh.geometry, mesh.material, null);
  const weightsOf = (mesh) => [...mesh.morphTargetInfluences];

  test('a mesh is driven whenever it is drawn, from what was set last', () => {
    const mesh = meshOf(mark());
    assert.deepEqual(three.attach(mesh), [mesh]);
    set(mesh);
    draw(mesh);
    assert.deepEqual(weightsOf(mesh), DRIVEN);
    set(mesh, [1, -2]);
    draw(mesh);
    assert.deepEqual(weightsOf(mesh), [1, -2, -2, 0, 0]);
  });

  test('several meshes below one object are driven, each by its own mark or that above', () => {
    const root = new THREE.Group(), head = new THREE.Group(), eyes = meshOf(mark()), plain = meshOf({});
    head.userData = mark();
    const parts = [meshOf({}), meshOf({})];
    head.add(...parts);
    root.add(head, eyes, plain, new THREE.Object3D());
    assert.deepEqual(three.attach(root), [...parts, eyes]);
    [...parts, eyes, plain].forEach((mesh) => set(mesh));
    [...parts, eyes, plain].forEach(draw);
    [...parts, eyes].forEach((mesh) => assert.deepEqual(weightsOf(mesh), DRIVEN));
    assert.deepEqual(weightsOf(plain), [...SET, 0, 0, 0]);
  });

  test('attaching twice drives once, and detaching once ends it', () => {
    const mesh = meshOf(mark());
    let called = 0;
    mesh.onBeforeRender = () => ++called;
    assert.deepEqual(three.attach(mesh), [mesh]);
    assert.deepEqual(three.attach(mesh), [mesh]);
    set(mesh);
    draw(mesh);
    assert.equal(called, 1);
    three.detach(mesh);
    assert.deepEqual(weightsOf(mesh), [...SET, 0, 0, 0]);
    draw(mesh);
    assert.equal(called, 2);
    assert.deepEqual(weightsOf(mesh), [...SET, 0, 0, 0]);
    three.detach(mesh);
    assert.deepEqual(three.attach(mesh), [mesh]);
    draw(mesh);
    assert.deepEqual(weightsOf(mesh), DRIVEN);
  });

  test('what an application has put around it since stays when it ends', () => {
    const mesh = meshOf(mark());
    three.attach(mesh);
    const ours = mesh.onBeforeRender;
    let called = 0;
    mesh.onBeforeRender = function (...all) {
      ++called;
      ours.apply(this, all);
    };
    set(mesh);
    draw(mesh);
    assert.deepEqual(weightsOf(mesh), DRIVEN);
    three.detach(mesh);
    draw(mesh);
    assert.deepEqual(weightsOf(mesh), [...SET, 0, 0, 0]);
    assert.equal(called, 2);
  });

  test('clones are driven when they are attached themselves, each by its own weights', () => {
    for (const cloneOf of [(root) => root.clone(), cloneWithSkeletons]) {
      const root = new THREE.Group();
      root.add(meshOf(mark()));
      three.attach(root);
      const copy = cloneOf(root), [first, second] = [root.children[0], copy.children[0]];
      [first, second].forEach((mesh) => set(mesh));
      [first, second].forEach(draw);
      assert.deepEqual(weightsOf(second), [...SET, 0, 0, 0]);
      assert.deepEqual(three.attach(copy), [second]);
      set(second, [1, 1]);
      [first, second].forEach(draw);
      assert.deepEqual(weightsOf(first), DRIVEN);
      assert.deepEqual(weightsOf(second), [1, 1, 1, 0, 0]);
      three.detach(root);
      draw(second);
      assert.deepEqual(weightsOf(second), [1, 1, 1, 0, 0]);
    }
  });

  test('instances get the weights of a mesh that is driven by hand', () => {
    const mesh = meshOf(mark()), instances = new THREE.InstancedMesh(mesh.geometry, mesh.material, 2);
    set(mesh);
    three.drive(mesh);
    assert.deepEqual(weightsOf(mesh), DRIVEN);
    instances.setMorphAt(1, mesh);
    const found = meshOf({});
    instances.getMorphAt(1, found);
    assert.deepEqual(weightsOf(found), DRIVEN);
    three.drive(new THREE.Group().add(meshOf({}), new THREE.Object3D()));
  });

  test('clips that a mixer blends give the weights that belong to the blend', () => {
    const mesh = meshOf(mark());
    const clip = (name, weights) => {
      const track = new THREE.NumberKeyframeTrack('face.morphTargetInfluences', [0], weights);
      return new THREE.AnimationClip(name, 1, [track]);
    };
    // The weights of correction targets in the clips of a baked file are right only if one clip plays alone. Target 4
    // is driven only by clips.
    const clips = [clip('a', [1, 0, 0, 0, 0.5]), clip('b', [0, 0.5, 0, 0, 0])];
    const mixer = new THREE.AnimationMixer(mesh);
    clips.forEach((each) => mixer.clipAction(each).setEffectiveWeight(0.5).play());
    three.attach(mesh);
    mixer.update(0.1);
    draw(mesh);
    assert.deepEqual(weightsOf(mesh), [0.5, 0.25, 0.125, 0.25, 0.25]);
    const copy = mesh.clone(), other = new THREE.AnimationMixer(copy);
    other.clipAction(clips[0]).play();
    three.attach(copy);
    other.update(0.1);
    [mesh, copy].forEach(draw);
    assert.deepEqual(weightsOf(copy), [1, 0, 0, 0, 0.5]);
    assert.deepEqual(weightsOf(mesh), [0.5, 0.25, 0.125, 0.25, 0.25]);
  });

  test('a mesh that has other targets by now is left alone', () => {
    for (const count of [2, 18]) { // fewer or more targets, as after VRMUtils.combineMorphs()
      const geometry = new THREE.BoxGeometry();
      geometry.morphAttributes.position = Array.from({ length: count }, () => geometry.attributes.position.clone());
      const mesh = new THREE.Mesh(geometry);
      mesh.userData = mark();
      assert.deepEqual(three.attach(mesh), []);
      three.drive(mesh);
      three.detach(mesh);
      assert.deepEqual(weightsOf(mesh), Array(count).fill(0));
    }
  });
});

test('an argument of another kind is refused by a TypeError that names the kind that is needed', () => {
  const root = new THREE.Group(), app = { root: { findComponents: () => [] }, on() {}, off() {} };
  for (const name of ['attach', 'detach', 'drive']) {
    for (const wrong of [undefined, null, {}, new THREE.BoxGeometry()]) {
      assert.throws(() => three[name](wrong), { name: 'TypeError', message: `${name}() needs an Object3D of three.js` });
    }
    // A GLTFLoader returns such an object.
    assert.throws(() => three[name]({ scene: root, animations: [] }), { name: 'TypeError', message: /pass its member scene, as gltf\.scene$/ });
    three[name](root);
  }
  for (const wrong of [undefined, null, {}, root, { meshes: [] }]) {
    assert.throws(() => babylon.attach(wrong), { name: 'TypeError', message: /^attach\(\) needs the scene of Babylon\.js/ });
    assert.throws(() => playcanvas.attach(wrong), { name: 'TypeError', message: /^attach\(\) needs the application of PlayCanvas/ });
  }
  for (const wrong of [undefined, null, {}, { resource: null }, { resource: {} }, { resource: { data: {} } }]) {
    assert.throws(() => playcanvas.attach(app, wrong), { name: 'TypeError', message: /^attach\(\) needs loaded assets of PlayCanvas/ });
  }
  assert.deepEqual(playcanvas.attach(app), []);
});

describe('Babylon.js', () => {
  function sceneOf() {
    const scene = new Scene(new NullEngine());
    new FreeCamera('camera', new Vector3(0, 0, -5), scene);
    return scene;
  }
  // Makes a mesh with five targets, whose metadata have the extras of a glTF file in the form of the loader of
  // Babylon.js.
  function meshOf(scene, extras = mark()) {
    const mesh = CreateBox('face', {}, scene), manager = new MorphTargetManager(scene);
    for (let k = 0; k < TARGETS; ++k) manager.addTarget(MorphTarget.FromMesh(mesh, `target ${k}`, 0));
    mesh.morphTargetManager = manager;
    mesh.metadata = { gltf: { extras } };
    return mesh;
  }
  const set = ({ morphTargetManager }, weights = SET) => weights.forEach((weight, i) => (morphTargetManager.getTarget(i).influence = weight));
  const weightsOf = ({ morphTargetManager }) => Array.from({ length: TARGETS }, (_, k) => morphTargetManager.getTarget(k).influence);

  test('all meshes of a scene are driven before each drawing, from what was set last', () => {
    const scene = sceneOf(), meshes = [meshOf(scene), meshOf(scene)], plain = meshOf(scene, {});
    assert.deepEqual(babylon.attach(scene), meshes);
    set(meshes[0]);
    set(meshes[1], [1, 1]);
    set(plain);
    scene.render();
    assert.deepEqual(weightsOf(meshes[0]), DRIVEN);
    assert.deepEqual(weightsOf(meshes[1]), [1, 1, 1, 0, 0]);
    assert.deepEqual(weightsOf(plain), [...SET, 0, 0, 0]);
    set(meshes[0], [1, -2]);
    scene.render();
    assert.deepEqual(weightsOf(meshes[0]), [1, -2, -2, 0, 0]);
  });

  test('attaching again takes in what has come since, and detaching once ends it', () => {
    const scene = sceneOf(), first = meshOf(scene);
    babylon.attach(scene);
    const second = meshOf(scene);
    assert.deepEqual(babylon.attach(scene), [first, second]);
    [first, second].forEach((mesh) => set(mesh));
    scene.render();
    [first, second].forEach((mesh) => assert.deepEqual(weightsOf(mesh), DRIVEN));
    babylon.detach(scene);
    scene.render();
    [first, second].forEach((mesh) => assert.deepEqual(weightsOf(mesh), [...SET, 0, 0, 0]));
    babylon.detach(scene);
  });

  test('clones and instances share the weights of their mesh, also when that is gone', () => {
    const scene = sceneOf(), mesh = meshOf(scene);
    const copy = mesh.clone('copy'), instance = mesh.createInstance('instance');
    assert.ok(instance);
    assert.deepEqual(babylon.attach(scene), [mesh, copy]);
    set(mesh);
    scene.render();
    assert.deepEqual(weightsOf(copy), DRIVEN);
    instance.dispose();
    mesh.dispose();
    set(copy, [1, 1]);
    scene.render();
    assert.deepEqual(weightsOf(copy), [1, 1, 1, 0, 0]);
  });

  test('copies that a container makes have weights of their own', () => {
    const scene = sceneOf(), mesh = meshOf(scene), container = new AssetContainer(scene);
    container.meshes.push(mesh);
    const [copy] = container.instantiateModelsToScene().rootNodes;
    assert.notEqual(copy.morphTargetManager, mesh.morphTargetManager);
    assert.deepEqual(babylon.attach(scene), [mesh, copy]);
    set(copy);
    scene.render();
    assert.deepEqual(weightsOf(copy), DRIVEN);
    assert.deepEqual(weightsOf(mesh), [0, 0, 0, 0, 0]);
  });

  test('animation groups that are blended give the weights that belong to the blend', () => {
    const scene = sceneOf(), mesh = meshOf(scene);
    const group = (name, weights) => {
      const made = new AnimationGroup(name, scene);
      weights.forEach((weight, k) => {
        const animation = new Animation(`${name} ${k}`, 'influence', 60, Animation.ANIMATIONTYPE_FLOAT);
        animation.setKeys([{ frame: 0, value: weight }, { frame: 60, value: weight }]);
        made.addTargetedAnimation(animation, mesh.morphTargetManager.getTarget(k));
      });
      made.start(true);
      made.setWeightForAllAnimatables(0.5);
      return made;
    };
    group('a', [1, 0, 0, 0, 0.5]);
    group('b', [0, 0.5, 0, 0, 0]);
    babylon.attach(scene);
    for (let frame = 0; frame < 3; ++frame) scene.render();
    assert.deepEqual(weightsOf(mesh), [0.5, 0.25, 0.125, 0.25, 0.25]);
  });
});
