// Defines shaders that draw a mesh with its rendered or its true normals. The shaders show the mesh lit, the normals as
// colours, or the angle between rendered and true normals as colours.

export const LIT = 0, NORMALS = 1, ERROR = 2, PLAIN = 3;

export const vertexShader = `
attribute vec3 shown;
attribute vec3 right;
attribute float degrees;
uniform bool isRight;
varying vec3 vNormal;
varying vec3 vPosition;
varying float vDegrees;

void main() {
  vec4 position4 = modelViewMatrix * vec4(position, 1.0);
  vPosition = position4.xyz;
  vNormal = normalMatrix * (isRight ? right : shown);
  vDegrees = degrees;
  gl_Position = projectionMatrix * position4;
}`;

// The light comes from three lights that are fixed to the camera: a key light with a sharp highlight, which reveals
// every bump of the normals, a fill light and a rim light.
export const fragmentShader = `
uniform int mode;
uniform float scale;
uniform vec3 palette[16];
varying vec3 vNormal;
varying vec3 vPosition;
varying float vDegrees;

vec3 colourOf(float x) {
  float at = clamp(x, 0.0, 1.0) * 15.0;
  int i = min(int(at), 14);
  return mix(palette[i], palette[i + 1], at - float(i));
}

vec3 lit(vec3 n, vec3 eye) {
  vec3 key = normalize(vec3(-0.55, 0.65, 0.75)), fill = normalize(vec3(0.9, 0.1, 0.45)), rim = normalize(vec3(0.2, 0.5, -0.9));
  vec3 clay = vec3(0.60, 0.49, 0.41);
  float sky = 0.5 + 0.5 * n.y;
  vec3 light = mix(vec3(0.10, 0.09, 0.10), vec3(0.17, 0.18, 0.21), sky);
  light += vec3(0.95, 0.90, 0.82) * max(dot(n, key), 0.0) + vec3(0.16, 0.20, 0.28) * max(dot(n, fill), 0.0);
  light += vec3(0.35, 0.38, 0.45) * pow(max(dot(n, rim), 0.0), 2.0);
  float shine = pow(max(dot(n, normalize(key + eye)), 0.0), 48.0) + 0.35 * pow(max(dot(n, normalize(fill + eye)), 0.0), 24.0);
  return pow(clay * light + vec3(0.42) * shine, vec3(1.0 / 2.2));
}

void main() {
  vec3 eye = normalize(-vPosition);
  vec3 face = normalize(cross(dFdx(vPosition), dFdy(vPosition)));
  bool hasNone = dot(vNormal, vNormal) < 1e-8;
  bool isJudged = vDegrees > -0.5;
  vec3 n = hasNone ? face : normalize(vNormal);
  // The back of a face has the opposite normal. A face that is seen nearly edge on keeps its normal, since otherwise
  // the shading would jump at silhouettes.
  if (!gl_FrontFacing && !hasNone && abs(dot(face, eye)) > 0.3) n = -n;
  if (mode == ${ERROR}) {
    float depth = 0.72 + 0.28 * max(dot(face, eye), 0.0);
    gl_FragColor = vec4((isJudged ? colourOf(vDegrees / scale) : vec3(0.5)) * depth, 1.0);
  } else if (mode == ${PLAIN}) {
    gl_FragColor = vec4(vec3(0.35 + 0.3 * max(dot(face, eye), 0.0)), 1.0);
  } else if (hasNone && isJudged) {
    gl_FragColor = vec4(0.0, 0.0, 0.0, 1.0);
  } else {
    gl_FragColor = vec4(mode == ${NORMALS} ? 0.5 + 0.5 * n : lit(n, eye), 1.0);
  }
}`;
