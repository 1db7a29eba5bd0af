/*
 * The look of a head: one source for WebGL 2 and OpenGL 3.3. The client puts `#version` and the defines before it
 * (look.json: `defines`, then those of the part's finish, then HAS_MAP, HAS_NORMAL, CUTOFF, SHADOW, THRIFTY as needed).
 * What changes slowly over a face is computed here, for each vertex.
 *
 * attributes  position, normal (head space, metres, deformed), uv (glTF: v grows downwards in the picture)
 *
 * uniforms (the rest in head.frag)
 * viewMatrix, projectionMatrix  mat4  of the camera
 * rest                          mat4  undoes the turn of the head (FAPs 48-50): head space to where the file has it
 * anchor                        vec3  what analytic shade is measured from, where the file has it: the centre of the
 *                                     eyeball's box for eyes, the head's `mouth.center` for everything else
 * shadowMatrix                  mat4  head space to the clip space of the key light; with SHADOW
 */
#ifdef GL_ES
precision highp float;
#endif

uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform mat4 rest;
uniform vec3 anchor;

in vec3 position;
in vec3 normal;
in vec2 uv;

out vec3 at;
out vec3 facing;
out vec2 place;
/** Diffuse light of all but the key lamp, and the share of light that the neighbourhood lets in. */
out vec4 room;
#ifdef SHADOW
uniform mat4 shadowMatrix;
/** Where the key light sees it, and how soft shadows are there. */
out vec4 lightSpace;
#endif

/** Light that the neighbourhood keeps away, where no picture can know it: `off` is the way from the anchor. */
float openness(vec3 off) {
#ifdef SKIN
  float under = smoothstep(0.045, 0.07, -off.y) * smoothstep(0.025, 0.06, -off.z) * (1.0 - 0.6 * smoothstep(0.07, 0.14, -off.y));
  return 1.0 - 0.3 * under;
#elif defined(HOLLOW)
  return mix(0.16, 1.0, smoothstep(-0.050, -0.004, off.z)) * mix(0.6, 1.0, smoothstep(-0.02, 0.004, 0.012 - off.y));
#elif defined(EYE)
  float lids = smoothstep(-0.0015, 0.0055, off.y) * 0.6 + smoothstep(0.001, 0.007, -off.y) * 0.35;
  float corners = smoothstep(0.004, 0.0125, abs(off.x)) * 0.55;
  return 0.9 * (1.0 - lids) * (1.0 - corners);
#else
  return 1.0;
#endif
}

/** Light from a lesser lamp, which goes on scattering past the terminator. */
float wrapped(float nl) {
  return clamp((nl + SCATTER.y) / (1.0 + SCATTER.y), 0.0, 1.0);
}

vec3 lesserLights(vec3 n, vec3 off) {
  vec3 light = 0.20 * FILL * wrapped(dot(n, FILL_FROM)) + 0.34 * RIM * wrapped(dot(n, RIM_FROM)) + 0.30 * mix(GROUND, SKY, 0.5 + 0.5 * n.y);
#ifdef SKIN
  // the ear on the rim light's side lets it shine through
  float ear = smoothstep(0.058, 0.07, off.x * sign(RIM_FROM.x)) * smoothstep(-0.01, 0.02, off.y) * smoothstep(0.055, 0.075, -off.z);
  light += 0.3 * ear * clamp(0.1 - dot(n, RIM_FROM), 0.0, 1.0) * RIM * vec3(1.0, 0.22, 0.12);
#endif
  return light;
}

void main() {
  at = position;
  facing = normal;
  place = uv;
  vec3 off = (rest * vec4(position, 1.0)).xyz - anchor;
  float open = openness(off);
  room = vec4(open * lesserLights(normal, off), open);
#ifdef SHADOW
  vec4 seen = shadowMatrix * vec4(position + normal * SHADOW_LIFT, 1.0);
  // neck and shoulders are far from what stands in the light
  float spread = SHADOW_SOFT * (1.0 + 1.8 * smoothstep(0.05, 0.15, -off.y));
  lightSpace = vec4(0.5 + 0.5 * seen.xyz - vec3(0.0, 0.0, 0.9 * (spread - SHADOW_SOFT)), spread);
#endif
  gl_Position = projectionMatrix * (viewMatrix * vec4(position, 1.0));
}
