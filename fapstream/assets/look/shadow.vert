/* The head as the key light sees it: depth and nothing else. CUTOFF and HAS_MAP as in head.vert. */
#ifdef GL_ES
precision highp float;
#endif

uniform mat4 shadowMatrix;

in vec3 position;
#ifdef CUTOFF
in vec2 uv;
out vec2 place;
#endif

void main() {
#ifdef CUTOFF
  place = uv;
#endif
  gl_Position = shadowMatrix * vec4(position, 1.0);
}
