#ifdef GL_ES
precision highp float;
#endif

#ifdef CUTOFF
uniform sampler2D map;
in vec2 place;
#endif
out vec4 color;

void main() {
#ifdef CUTOFF
  // blurred: strands cast the shadow of their lock
  if (texture(map, place, 3.0).a < CUTOFF) discard;
#endif
  color = vec4(1.0);
}
