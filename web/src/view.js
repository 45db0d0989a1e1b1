// Draws the picture: the rendered and the true mesh with one camera, side by side or on the two sides of a movable
// border (a wipe).
import { BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, LineBasicMaterial, LineLoop, Mesh, PerspectiveCamera, Scene, ShaderMaterial, Sphere, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { VIRIDIS, degreesText } from './colors.js';
import { ERROR, LIT, NORMALS, PLAIN, fragmentShader, vertexShader } from './shaders.js';
import { meet } from './pick.js';

const MODES = { lit: LIT, normals: NORMALS, error: ERROR };

const MARGIN = 8; // pixels between a label and the edges of its side (style.css)
const LEAST_LABEL = 90; // pixels: a narrower side has no label
const FLIGHT = 600; // milliseconds that the camera takes to fly to a place
const FRONT = new Vector3(0.32, 0.16, 1); // the direction from the mesh to the camera of the first picture
const LEAST_COSINE = 0.3; // of the angle between a normal and the direction to a camera that shows a vertex well
const ease = (x) => x * x * (3 - 2 * x);
const calm = () => matchMedia('(prefers-reduced-motion: reduce)').matches;

const element = (parent, name) => {
  const made = document.createElement('div');
  made.className = name;
  parent.append(made);
  return made;
};

/**
 * Makes the picture.
 * @param {HTMLElement} stage gets a canvas, and the labels above it
 * @param {(found: {vertex: number, triangle: number, x: number, y: number} | null) => void} onPoint is called with the
 *   vertex under the pointer
 * @param {(triangle: number) => void} onPick is called with the triangle that was clicked
 */
export function makeView(stage, onPoint, onPick) {
  const renderer = new WebGLRenderer({ antialias: true, alpha: true });
  renderer.setClearAlpha(0);
  renderer.setScissorTest(true);
  renderer.domElement.tabIndex = -1;
  stage.append(renderer.domElement);

  const scene = new Scene(), camera = new PerspectiveCamera(30, 1, 0.01, 100);
  const uniforms = {
    isRight: { value: false },
    mode: { value: LIT },
    scale: { value: 1 },
    palette: { value: VIRIDIS.map((rgb) => new Color(...rgb)) },
  };
  const material = new ShaderMaterial({ uniforms, vertexShader, fragmentShader, side: DoubleSide });
  const plain = new ShaderMaterial({ uniforms: { ...uniforms, mode: { value: PLAIN } }, vertexShader, fragmentShader, side: DoubleSide });
  // The outline marks the face that a person has picked. The outline is visible through the parts of the mesh in front
  // of the face.
  const outline = new LineLoop(new BufferGeometry(), new LineBasicMaterial({ color: 0xff8a00, depthTest: false }));
  let outlined = [];
  Object.assign(outline, { frustumCulled: false, renderOrder: 1, visible: false });
  scene.add(outline);
  const placeOutline = () => {
    outline.visible = outlined.length > 0;
    const { position } = outline.geometry.attributes;
    if (!outline.visible || !position) return;
    outlined.forEach((v, i) => position.setXYZ(i, surface.positions[3 * v], surface.positions[3 * v + 1], surface.positions[3 * v + 2]));
    position.needsUpdate = true;
  };
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.enableDamping = false;
  controls.addEventListener('change', () => request());

  const view = { layout: 'side', mode: 'lit', wipe: 0.5 };
  let part, surface, attributes = [], meshes = [], radius = 1, marked = -1, pending = false, flight = 0;
  const labels = [0, 1].map(() => element(stage, 'label')), markers = [0, 1].map(() => element(stage, 'marker'));
  const handle = element(stage, 'wipe');
  Object.assign(handle, { tabIndex: 0, role: 'slider', ariaLabel: 'Dividing line between the left and the right view' });

  // Returns the rectangle of each side in CSS pixels from the top left, and the part of the rectangle that is visible.
  function panes() {
    const width = stage.clientWidth, height = stage.clientHeight;
    if (view.layout === 'wipe') {
      const at = Math.round(view.wipe * width), whole = { x: 0, y: 0, width, height };
      return [{ ...whole, clip: { x: 0, y: 0, width: at, height } }, { ...whole, clip: { x: at, y: 0, width: width - at, height } }];
    }
    const both = width >= height
      ? [{ x: 0, y: 0, width: Math.floor(width / 2), height }, { x: Math.floor(width / 2), y: 0, width: width - Math.floor(width / 2), height }]
      : [{ x: 0, y: 0, width, height: Math.floor(height / 2) }, { x: 0, y: Math.floor(height / 2), width, height: height - Math.floor(height / 2) }];
    return both.map((pane) => ({ ...pane, clip: pane }));
  }

  function aim(pane) {
    camera.aspect = pane.width / Math.max(pane.height, 1);
    camera.updateProjectionMatrix();
  }

  function place(marker, pane) {
    marker.hidden = marked < 0;
    if (marked < 0) return;
    const at = new Vector3().fromArray(surface.positions, 3 * marked).project(camera);
    const x = pane.x + ((at.x + 1) / 2) * pane.width, y = pane.y + ((1 - at.y) / 2) * pane.height;
    const { clip } = pane;
    marker.hidden = at.z > 1 || x < clip.x || x > clip.x + clip.width || y < clip.y || y > clip.y + clip.height;
    const normal = new Vector3().fromArray(surface.right, 3 * marked), seen = camera.position.clone().sub(new Vector3().fromArray(surface.positions, 3 * marked));
    marker.classList.toggle('behind', normal.dot(seen) < 0);
    marker.style.transform = `translate(${x}px, ${y}px)`;
    marker.textContent = degreesText(surface.degrees[marked]);
  }

  function draw() {
    pending = false;
    if (!surface) return;
    renderer.setScissor(0, 0, stage.clientWidth, stage.clientHeight);
    renderer.clear();
    const height = stage.clientHeight;
    panes().forEach((pane, side) => {
      const { clip } = pane;
      aim(pane);
      renderer.setViewport(pane.x, height - pane.y - pane.height, pane.width, pane.height);
      renderer.setScissor(clip.x, height - clip.y - clip.height, clip.width, clip.height);
      uniforms.isRight.value = side === 1;
      uniforms.mode.value = view.mode === 'error' && side === 0 ? LIT : MODES[view.mode];
      if (clip.width > 0) renderer.render(scene, camera);
      place(markers[side], pane);
      Object.assign(labels[side].style, { left: `${clip.x}px`, top: `${clip.y}px`, maxWidth: `${clip.width - 2 * MARGIN}px` });
      labels[side].hidden = clip.width < LEAST_LABEL;
    });
    handle.hidden = view.layout !== 'wipe';
    handle.style.left = `${Math.round(view.wipe * stage.clientWidth)}px`;
    handle.ariaValueNow = String(Math.round(100 * view.wipe));
  }

  function request() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(draw);
  }

  // Returns the box around the mesh. The weights in a file may be NaN, and positions are then NaN as well. The
  // comparisons skip such positions.
  function bounds() {
    const { positions } = surface, least = [Infinity, Infinity, Infinity], most = [-Infinity, -Infinity, -Infinity];
    for (const triangles of [part.triangles, part.coarse ?? []]) {
      for (const v of triangles) {
        for (let c = 0; c < 3; ++c) {
          const x = positions[3 * v + c];
          if (x < least[c]) least[c] = x;
          if (x > most[c]) most[c] = x;
        }
      }
    }
    const hasPlace = [...least, ...most].every(Number.isFinite), none = [0, 0, 0];
    const [low, high] = [new Vector3(...(hasPlace ? least : none)), new Vector3(...(hasPlace ? most : none))], centre = low.clone().add(high).multiplyScalar(0.5);
    return { centre, low, high, size: high.distanceTo(centre) || 1 };
  }

  // Moves the camera in a short flight, or at once for people who have set the system to reduced motion.
  function fly(position, target, onEnd) {
    const from = camera.position.clone(), to = controls.target.clone(), begin = performance.now(), mine = ++flight;
    const step = (now) => {
      if (mine !== flight) return;
      const x = calm() ? 1 : Math.min(Math.max((now - begin) / FLIGHT, 0), 1), t = ease(x);
      camera.position.lerpVectors(from, position, t);
      controls.target.lerpVectors(to, target, t);
      controls.update();
      request();
      if (x < 1) requestAnimationFrame(step);
      else onEnd?.();
    };
    step(begin);
  }

  // Returns the distance at which a sphere of radius `size` fills the smaller side of a pane.
  function distanceOf(size) {
    const [{ width, height }] = panes(), aspect = width / Math.max(height, 1);
    const half = Math.tan((camera.fov * Math.PI) / 360) * Math.min(1, aspect);
    return (size * 1.02) / half;
  }

  /** Shows another mesh. newSurface has the arrays that are drawn (surface.js). */
  view.show = (newPart, newSurface) => {
    [part, surface] = [newPart, newSurface];
    for (const mesh of meshes) scene.remove(mesh);
    meshes[0]?.geometry.dispose();
    attributes = [['position', 'positions', 3], ['shown', 'shown', 3], ['right', 'right', 3], ['degrees', 'degrees', 1]].map(
      ([name, member, size]) => [name, new BufferAttribute(surface[member], size).setUsage(DynamicDrawUsage)]);
    const geometryOf = (triangles) => {
      const geometry = new BufferGeometry();
      geometry.boundingSphere = new Sphere(); // the radius is not positive, so nothing is culled or sorted
      for (const [name, attribute] of attributes) geometry.setAttribute(name, attribute);
      return geometry.setIndex(new BufferAttribute(triangles, 1));
    };
    meshes = [new Mesh(geometryOf(part.triangles), material)];
    if (part.coarse?.length) meshes.push(new Mesh(geometryOf(part.coarse), plain));
    for (const mesh of meshes) {
      mesh.frustumCulled = false;
      scene.add(mesh);
    }
    marked = -1;
    view.outline([]);
  };

  /** Draws again after the arrays of the surface have changed. */
  view.update = () => {
    for (const [, attribute] of attributes) attribute.needsUpdate = true;
    placeOutline();
    request();
  };

  /** Outlines the face with these corners, or no face if the list is empty. */
  view.outline = (corners) => {
    outlined = corners;
    outline.geometry.dispose();
    outline.geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(3 * corners.length), 3));
    placeOutline();
    request();
  };

  /** Moves the camera so that the whole mesh is seen, by default from slightly beside the front. */
  view.frame = (atOnce, direction = FRONT) => {
    const { centre, size } = bounds();
    radius = size;
    camera.near = size / 200;
    camera.far = size * 60;
    controls.minDistance = size / 40;
    controls.maxDistance = size * 20;
    const position = direction.clone().setLength(distanceOf(size)).add(centre);
    if (!atOnce) return fly(position, centre);
    ++flight;
    camera.position.copy(position);
    controls.target.copy(centre);
    controls.update();
    request();
  };

  // Returns true if a camera that shows the whole mesh from a direction also shows a vertex: nothing is in the way, and
  // the true normal points to the camera.
  function shows(vertex, direction) {
    const { centre, size } = bounds(), target = new Vector3().fromArray(surface.positions, 3 * vertex);
    const normal = new Vector3().fromArray(surface.right, 3 * vertex);
    const way = direction.clone().setLength(distanceOf(size)).add(centre).sub(target).normalize();
    if (!(normal.dot(way) > LEAST_COSINE)) return false;
    const from = target.addScaledVector(way, 1e-3 * size);
    return meet(surface.positions, part.triangles, from.toArray(), way.toArray()).distance === Infinity;
  }

  /** Moves the camera at once so that it shows the whole mesh and marks a vertex in it. The camera is slightly beside the
   * front or, if `turns` is true, in the direction of the vertex's true normal. Returns false, and leaves the camera as
   * it is, if the vertex is invisible from there. */
  view.frameWith = (vertex, turns) => {
    const direction = turns ? new Vector3().fromArray(surface.right, 3 * vertex) : FRONT;
    if (!shows(vertex, direction)) return false;
    view.frame(true, direction);
    view.mark(vertex);
    return true;
  };

  /** Looks at a point from a direction. `shares` are the coordinates of the point as fractions of the box of the mesh.
   * `near` is a fraction of the distance at which the whole mesh is seen. */
  view.look = (shares, direction, near) => {
    const { low, high } = bounds();
    ++flight;
    controls.target.copy(high).sub(low).multiply(new Vector3(...shares)).add(low);
    camera.position.set(...direction).setLength(near * distanceOf(radius)).add(controls.target);
    controls.update();
    request();
  };

  // Returns the vector from a vertex to a camera that sees the vertex. Tries several directions around the normal, and
  // takes the first direction in which nothing is in the way for `distance`. If there is no such direction, takes the
  // direction with the longest free way, and shortens the vector to this way.
  function freeWay(target, normal, towards, distance) {
    const [side, up] = [new Vector3(normal.y, normal.z, normal.x).cross(normal), normal.clone()].map((v) => v.normalize());
    up.cross(side);
    const tilted = (a, b) => normal.clone().addScaledVector(side, a).addScaledVector(up, b);
    let best = { free: 0, direction: normal };
    for (const direction of [towards, normal.clone(), ...[[0.9, 0], [-0.9, 0], [0, 0.9], [0, -0.9], [2, 0], [-2, 0], [0, 2], [0, -2]].map((tilt) => tilted(...tilt))]) {
      direction.normalize();
      const from = target.clone().addScaledVector(direction, 1e-3 * radius);
      const free = meet(surface.positions, part.triangles, from.toArray(), direction.toArray()).distance;
      if (free > best.free) best = { free, direction };
      if (free >= distance) break;
    }
    return best.direction.clone().setLength(Math.max(Math.min(distance, 0.9 * best.free), 0.03 * radius));
  }

  /** Moves the camera near a vertex, to a place from which the vertex is visible. If possible, this place lies in the
   * direction of the true normal. */
  view.visit = (vertex) => {
    marked = vertex;
    const target = new Vector3().fromArray(surface.positions, 3 * vertex);
    if (!target.toArray().every(Number.isFinite)) return request();
    const normal = new Vector3().fromArray(surface.right, 3 * vertex);
    const towards = camera.position.clone().sub(controls.target).normalize().addScaledVector(normal, 1.5);
    if (towards.length() < 0.1) towards.copy(normal);
    fly(freeWay(target, normal, towards, distanceOf(radius) * 0.38).add(target), target);
  };
  view.mark = (vertex) => {
    marked = vertex;
    request();
  };

  /** Chooses the layout "side" or "wipe". The distance of the camera changes, so that the same part of the mesh stays
   * in view. */
  view.setLayout = (layout) => {
    const before = distanceOf(1);
    view.layout = layout;
    camera.position.sub(controls.target).multiplyScalar(distanceOf(1) / before).add(controls.target);
    controls.update();
    request();
  };
  view.setLabels = (texts) => texts.forEach((text, side) => (labels[side].textContent = text));
  view.setScale = (degrees) => {
    uniforms.scale.value = degrees;
    request();
  };
  view.request = request;
  view.draw = draw;
  view.camera = camera;
  view.canvas = renderer.domElement;

  function pointAt(event) {
    const box = stage.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    const pane = panes().find(({ clip }) => x >= clip.x && x < clip.x + clip.width && y >= clip.y && y < clip.y + clip.height);
    if (!pane || !surface) return null;
    aim(pane);
    const ray = new Vector3(((x - pane.x) / pane.width) * 2 - 1, 1 - ((y - pane.y) / pane.height) * 2, 0.5).unproject(camera).sub(camera.position);
    const { vertex, triangle } = meet(surface.positions, part.triangles, camera.position.toArray(), ray.toArray());
    return vertex < 0 ? null : { vertex, triangle, x, y };
  }
  let pointed;
  renderer.domElement.addEventListener('pointermove', (event) => {
    if (event.buttons !== 0) return onPoint(null);
    if (!pointed) requestAnimationFrame(() => {
      const last = pointed;
      pointed = undefined;
      onPoint(pointAt(last));
    });
    pointed = event;
  });
  renderer.domElement.addEventListener('pointerleave', () => onPoint(null));
  // The end of a drag also causes a click event. Only a click that ends near its start therefore picks a face.
  let pressed = [0, 0];
  renderer.domElement.addEventListener('pointerdown', (event) => (pressed = [event.clientX, event.clientY]));
  renderer.domElement.addEventListener('click', (event) => {
    const found = pointAt(event);
    onPoint(found);
    if (found && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 5) onPick(found.triangle);
  });

  const setWipe = (share) => {
    view.wipe = Math.min(Math.max(share, 0), 1);
    request();
  };
  handle.addEventListener('pointerdown', (event) => {
    handle.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  handle.addEventListener('pointermove', (event) => {
    const box = stage.getBoundingClientRect();
    if (handle.hasPointerCapture(event.pointerId)) setWipe((event.clientX - box.left) / box.width);
  });
  handle.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
    if (!step) return;
    event.stopPropagation();
    setWipe(view.wipe + step);
  });

  const resized = new ResizeObserver(() => {
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(stage.clientWidth, stage.clientHeight);
    draw();
  });
  resized.observe(stage);

  /** Releases the memory of the graphics card. */
  view.close = () => {
    ++flight;
    surface = undefined;
    resized.disconnect();
    controls.dispose();
    for (const mesh of meshes) mesh.geometry.dispose();
    renderer.dispose();
    renderer.forceContextLoss();
  };
  return view;
}
