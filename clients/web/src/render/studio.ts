/**
 * The look: one shader for every part, lit by a studio of three soft lights written into it. Skin scatters
 * (diffuse light wraps round further in red than in blue, after Jensen et al. 2001's dipole), reflections
 * are GGX for the lights and the studio itself for whatever is wet.
 */

import { Color, DoubleSide, FrontSide, ShaderMaterial, Vector3, type Texture } from "three";
import type { Head, Material } from "../head/model";

/** How a part takes the light; roughness and colour come from the file. */
interface Finish {
  /** How far diffuse light wraps, by colour. */
  scatter: [number, number, number];
  /** Share of the studio mirrored in it, and of the lights' highlights. */
  gloss: number;
  shine: number;
  /** Light lost towards the back of the mouth. */
  hollow: number;
}

const PLAIN: Finish = { scatter: [0.1, 0.1, 0.1], gloss: 0.1, shine: 0.3, hollow: 0 };
const FINISHES: [RegExp, Finish][] = [
  [/^skin|^face|^body|^lips/, { scatter: [0.38, 0.17, 0.1], gloss: 0.16, shine: 0.42, hollow: 0 }],
  [/^eye|^sclera|^iris/, { scatter: [0.2, 0.16, 0.16], gloss: 1, shine: 1, hollow: 0 }],
  [/^cornea|^tear/, { scatter: [0, 0, 0], gloss: 1.6, shine: 1, hollow: 0 }],
  [/^teeth|^gum/, { scatter: [0.25, 0.2, 0.15], gloss: 0.5, shine: 0.8, hollow: 1 }],
  [/^tongue|^mouth/, { scatter: [0.3, 0.15, 0.1], gloss: 0.4, shine: 0.7, hollow: 1 }],
  [/^hair|^brow|^lash/, { scatter: [0.2, 0.18, 0.16], gloss: 0.04, shine: 0.2, hollow: 0 }],
];

/** `thrifty` leaves out what is hardly seen, for processors that have to draw. */
export function materialFor(name: string, material: Material, head: Head, map: Texture | null, thrifty = false): ShaderMaterial {
  const finish = FINISHES.find(([pattern]) => pattern.test(name))?.[1] ?? PLAIN;
  const [r, g, b, opacity] = material.color;
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    defines: {
      ...(map && { HAS_MAP: 1 }),
      ...(material.alpha === "MASK" && { CUTOFF: material.cutoff.toFixed(3) }),
      ...(finish.gloss > (thrifty ? 0.3 : 0.05) && { MIRROR: 1 }),
      ...(finish.hollow && { HOLLOW: 1 }),
      ...(name.startsWith("skin") && { SKIN: 1 }),
    },
    uniforms: {
      map: { value: map },
      tint: { value: new Color().setRGB(r, g, b) },
      opacity: { value: opacity },
      roughness: { value: Math.max(0.08, material.roughness) },
      scatter: { value: new Vector3(...finish.scatter) },
      gloss: { value: finish.gloss },
      shine: { value: finish.shine },
      mouth: { value: new Vector3(...head.mouth.center) },
    },
    transparent: material.alpha === "BLEND",
    depthWrite: material.alpha !== "BLEND",
    side: material.doubleSided ? DoubleSide : FrontSide,
  });
}

const VERTEX = /* glsl */ `
varying vec3 at;
varying vec3 facing;
varying vec2 uvs;
void main() {
  at = position;
  facing = normal;
  uvs = uv;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const FRAGMENT = /* glsl */ `
uniform vec3 tint;
uniform float opacity;
uniform float roughness;
uniform vec3 scatter;
uniform float gloss;
uniform float shine;
uniform vec3 mouth;
#ifdef HAS_MAP
uniform sampler2D map;
#endif
varying vec3 at;
varying vec3 facing;
varying vec2 uvs;

const vec3 KEY_FROM = vec3(0.5718, 0.5145, 0.6392);
const vec3 KEY = vec3(1.0, 0.93, 0.84);
const vec3 FILL_FROM = vec3(-0.7682, 0.1097, 0.6307);
const vec3 FILL = vec3(0.80, 0.90, 1.0);
const vec3 RIM_FROM = vec3(-0.6247, 0.4165, -0.6605);
const vec3 RIM = vec3(0.95, 0.97, 1.0);
const vec3 SKY = vec3(0.66, 0.72, 0.80);
const vec3 GROUND = vec3(0.46, 0.36, 0.31);

float box(vec3 d, vec3 from, float size, float blur) {
  float c = dot(d, from);
  return smoothstep(size - blur, size + 0.25 * blur + 0.002, c);
}

vec3 studio(vec3 d, float rough) {
  float blur = 0.02 + 0.5 * rough;
  vec3 light = mix(GROUND, SKY, smoothstep(-1.0, 1.0, d.y)) * 0.55;
  light += 4.0 * KEY * box(d, KEY_FROM, 0.955, blur);
  light += 1.0 * FILL * box(d, FILL_FROM, 0.93, blur);
  return light;
}

float ggx(vec3 n, vec3 v, vec3 l, float rough) {
  vec3 h = normalize(v + l);
  float a = rough * rough;
  float nh = clamp(dot(n, h), 0.0, 1.0);
  float nl = clamp(dot(n, l), 0.0, 1.0);
  float lh = clamp(dot(l, h), 0.0, 1.0);
  float d = nh * nh * (a * a - 1.0) + 1.0;
  return nl * a * a / (d * d * max(0.1, lh * lh) * (rough * 4.0 + 2.0) * 3.14159);
}

vec3 soft(vec3 n, vec3 l) {
  vec3 lit = max((dot(n, l) + scatter) / (1.0 + scatter), 0.0);
  return lit * mix(lit, vec3(1.0), 0.45) / (1.0 + 0.5 * scatter);
}

/** ACES by Narkowicz, eased so that mid-tones keep their colour. */
vec3 film(vec3 x) {
  x *= 0.92;
  return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

/** sRGB to linear and back, by polynomial and by roots: a tenth of the price of powers, 1/255 off at most. */
vec3 linear(vec3 c) {
  return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878);
}

vec3 srgb(vec3 c) {
  vec3 a = sqrt(c);
  vec3 b = sqrt(a);
  return max(0.585122381 * a + 0.783140355 * b - 0.368262736 * sqrt(b), 0.0);
}

void main() {
  vec4 base = vec4(tint, opacity);
#ifdef HAS_MAP
  vec4 texel = texture2D(map, uvs);
  base *= vec4(linear(texel.rgb), texel.a);
#endif
#ifdef CUTOFF
  if (base.a < CUTOFF) discard;
#endif
  vec3 n = normalize(facing);
  if (!gl_FrontFacing) n = -n;
  vec3 v = normalize(cameraPosition - at);
  float nv = clamp(dot(n, v), 0.0, 1.0);
  vec3 diffuse = 0.92 * KEY * soft(n, KEY_FROM) + 0.24 * FILL * soft(n, FILL_FROM) + 0.55 * RIM * soft(n, RIM_FROM)
    + 0.34 * mix(GROUND, SKY, 0.5 + 0.5 * n.y);
  vec3 lobes = 1.0 * KEY * ggx(n, v, KEY_FROM, roughness) + 0.3 * FILL * ggx(n, v, FILL_FROM, roughness)
    + 1.6 * RIM * ggx(n, v, RIM_FROM, roughness);
  vec3 shining = 0.5 * shine * lobes;
#ifdef MIRROR
  float graze = (1.0 - nv) * (1.0 - nv);
  float fresnel = 0.04 + 0.96 * graze * graze * (1.0 - nv) * (1.0 - 0.7 * roughness);
  shining += gloss * fresnel * studio(reflect(-v, n), roughness);
#endif
  float depth = 1.0;
#ifdef SKIN
  vec3 off = mouth - at;
  float under = smoothstep(0.045, 0.07, off.y) * smoothstep(0.025, 0.06, off.z) * (1.0 - 0.6 * smoothstep(0.07, 0.14, off.y));
  depth = 1.0 - 0.4 * under;
#endif
#ifdef HOLLOW
  depth = mix(0.12, 1.0, smoothstep(-0.034, 0.002, at.z - mouth.z)) * mix(0.6, 1.0, smoothstep(-0.02, 0.004, mouth.y - at.y + 0.012));
#endif
  vec3 light = film((base.rgb * diffuse + shining) * depth);
  gl_FragColor = vec4(srgb(light), base.a);
}`;
