/*
 * Light on a head (attributes, defines and the other uniforms: head.vert).
 *
 * cameraPosition  vec3             head space, metres
 * tint            vec4             the material's linear RGBA
 * roughness       float            the material's
 * map             sampler2D        sRGB picture, straight alpha; with HAS_MAP
 * normalMap       sampler2D        tangent space, +y up; with HAS_NORMAL
 * normalRepeat    float            how often it tiles; with HAS_NORMAL
 * shadowMap       sampler2DShadow  depth from the key light, compared <=, linear; with SHADOW
 *
 * Output: sRGB, straight alpha; opaque with CUTOFF.
 */
#ifdef GL_ES
precision highp float;
precision highp sampler2DShadow;
#endif

uniform vec3 cameraPosition;
uniform vec4 tint;
uniform float roughness;
#ifdef HAS_MAP
uniform sampler2D map;
#endif
#ifdef HAS_NORMAL
uniform sampler2D normalMap;
uniform float normalRepeat;
#endif
#ifdef SHADOW
uniform sampler2DShadow shadowMap;
in vec4 lightSpace;
#endif

in vec3 at;
in vec3 facing;
in vec2 place;
in vec4 room;
out vec4 color;

/** sRGB to linear and back, by polynomial and by roots: a tenth of the price of powers, 1/255 off at most. */
vec3 linear(vec3 c) {
  return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878);
}

vec3 srgb(vec3 c) {
  vec3 a = sqrt(c);
  vec3 b = sqrt(a);
  return max(0.585122381 * a + 0.783140355 * b - 0.368262736 * sqrt(b), 0.0);
}

/** ACES by Narkowicz, eased so that mid-tones keep their colour. */
vec3 film(vec3 x) {
  x *= 0.82;
  return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

/** Unit vectors of growing u and v in the surface with normal n, from what changes between neighbouring pixels
    (Schueler 2013, "Followup: Normal Mapping Without Precomputed Tangents"); zero where there are no coordinates. */
void along(vec3 n, out vec3 u, out vec3 v) {
  vec3 px = dFdx(at), py = dFdy(at);
  vec2 sx = dFdx(place), sy = dFdy(place);
  vec3 a = cross(py, n), b = cross(n, px);
  u = a * sx.x + b * sy.x;
  v = a * sx.y + b * sy.y;
  float most = max(dot(u, u), dot(v, v));
  float scale = most > 0.0 ? inversesqrt(most) : 0.0;
  u *= scale;
  v *= scale;
}

#ifdef HAS_NORMAL
/** The fine relief, and in w how much of it the distance has blurred away: that is rough instead (Toksvig 2005). */
vec4 relief(vec3 n) {
  vec3 u, v;
  along(n, u, v);
  vec3 t = texture(normalMap, place * normalRepeat).xyz * 2.0 - 1.0;
  vec3 bent = u * t.x - v * t.y + n * t.z;
  return vec4(normalize(bent), clamp(1.0 - length(t), 0.0, 1.0));
}
#endif

/** Share of the key light that comes through. The taps are turned from pixel to pixel (noise of Jimenez 2014), so
    that no steps are seen. */
float lit() {
#ifndef SHADOW
  return 1.0;
#elif defined(THRIFTY) && defined(HAIR)
  return mix(SHADE, 1.0, texture(shadowMap, lightSpace.xyz));
#else
  float c = 2.0 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 1.0;
  vec2 a = lightSpace.w * vec2(c, sqrt(1.0 - c * c));
  vec2 b = vec2(-0.5 * a.x - 0.866 * a.y, 0.866 * a.x - 0.5 * a.y);
  vec3 from = lightSpace.xyz;
  float sum = texture(shadowMap, from + vec3(a, 0.0)) + texture(shadowMap, from + vec3(b, 0.0)) + texture(shadowMap, from - vec3(a + b, 0.0));
#ifndef THRIFTY
  sum += texture(shadowMap, from - vec3(0.6 * a, 0.0)) + texture(shadowMap, from - vec3(0.6 * b, 0.0))
    + texture(shadowMap, from + vec3(0.6 * (a + b), 0.0));
  sum *= 0.5;
#endif
  return mix(SHADE, 1.0, sum / 3.0);
#endif
}

/** Diffuse light from l that goes on scattering past the terminator, furthest in red (after d'Eon and Irving 2011). */
vec3 soft(float nl) {
  vec3 wrapped = clamp((nl + SCATTER) / (1.0 + SCATTER), 0.0, 1.0);
  return wrapped * mix(wrapped, vec3(1.0), 0.45) / (1.0 + 0.5 * SCATTER);
}

float ggx(float nh, float nl, float lh, float rough) {
  float a = rough * rough;
  float d = nh * nh * (a * a - 1.0) + 1.0;
  return nl * a * a / (d * d * max(0.1, lh * lh) * (rough * 4.0 + 2.0) * 3.14159);
}

/** What a lamp's reflection adds: two lobes on skin, a rough one and that of its film of oil. */
float gleam(vec3 n, vec3 v, vec3 l, float rough) {
  vec3 h = normalize(v + l);
  float nh = clamp(dot(n, h), 0.0, 1.0);
  float nl = clamp(dot(n, l), 0.0, 1.0);
  float lh = clamp(dot(l, h), 0.0, 1.0);
#ifdef SKIN
  return mix(ggx(nh, nl, lh, rough), ggx(nh, nl, lh, 0.6 * rough), 0.18);
#else
  return ggx(nh, nl, lh, rough);
#endif
}

/** Schlick's, less at the edge of what is rough. */
float fresnel(vec3 n, vec3 v, float rough) {
  float c = 1.0 - clamp(dot(n, v), 0.0, 1.0);
  return 0.04 + 0.96 * c * c * c * c * c * (1.0 - 0.7 * rough);
}

float lamp(vec3 d, vec3 from, float size, float blur) {
  return smoothstep(size - blur, size + 0.25 * blur + 0.002, dot(d, from));
}

/** What is mirrored: the room and its two large lamps, the key one as low as photographers hang it for the eyes' sake. */
vec3 studio(vec3 d, float rough, float key) {
  float blur = 0.02 + 0.5 * rough;
  vec3 light = mix(GROUND, SKY, smoothstep(-1.0, 1.0, d.y)) * 0.55;
  light += 8.0 * key * KEY * lamp(d, LAMP_FROM, 0.97, 0.7 * blur);
  light += 0.8 * FILL * lamp(d, FILL_FROM, 0.95, blur);
  return light;
}

/** What falls on the skin from the key lamp and goes in; `nl` without the fine relief, `key` what comes through. */
vec3 diffused(vec3 n, float nl, float key) {
#ifdef SKIN
  // light bleeds into shadows, red furthest; the relief is blurred by what scatters below it
  vec3 through = vec3(mix(key, sqrt(key), 0.6), key, key * mix(1.0, key, 0.2));
  return KEY * through * soft(mix(nl, dot(n, KEY_FROM), 0.6));
#else
  return KEY * key * soft(nl);
#endif
}

#if defined(MIRROR)

vec3 reflected(vec3 n, vec3 v, float rough, float key) {
  return GLOSS * fresnel(n, v, rough) * studio(reflect(-v, n), rough, key);
}

#elif defined(HAIR)

/** Sine to the fourth between a strand and the half vector, the strand leaning by `lean` along the normal. */
float sine4(float sh, float nh, float lean) {
  float c = sh + lean * nh;
  float s = max(0.0, 1.0 - c * c / (1.0 + lean * lean));
  return s * s;
}

/**
 * Hair's two highlights, Kajiya and Kay 1989, shifted to tip and root as by Scheuermann 2004. `strands` runs from root to
 * tip; `own` is the hair's colour, which the inner reflection takes.
 */
vec3 strandsGleam(vec3 n, vec3 v, vec3 strands, vec3 own, float rough, float key) {
  vec3 h = normalize(v + KEY_FROM);
  float sh = dot(strands, h), nh = dot(n, h);
  float uneven = 0.35 * (dot(own, vec3(2.0)) - 0.1);
  float tip = sine4(sh, nh, uneven - 0.10), root = sine4(sh, nh, uneven + 0.12);
  float side = clamp(0.5 + dot(n, KEY_FROM), 0.0, 1.0) * key * min(1.0, 2.0 - 2.0 * rough);
  vec3 inner = 1.6 * own * (1.0 - 0.6 * own) * root * root * root;
  tip *= tip * tip;
  tip *= tip;
  vec3 light = SHINE * side * KEY * (0.10 * tip * tip + inner);
#ifndef THRIFTY
  vec3 g = normalize(v + RIM_FROM);
  float behind = sine4(dot(strands, g), dot(n, g), uneven - 0.10);
  light += 0.6 * SHINE * clamp(0.4 + dot(n, RIM_FROM), 0.0, 1.0) * RIM * (0.05 + own) * behind * behind * behind * behind;
#endif
  float across = dot(strands, v);
  return light + GLOSS * mix(GROUND, SKY, 0.5 + 0.5 * n.y) * (1.0 - across * across);
}

#else

/** Lamps in `gloss` of their strength, and the room. */
vec3 glossed(vec3 n, vec3 v, float rough, float key, float gloss) {
  vec3 lamps = KEY * key * gleam(n, v, KEY_FROM, rough) + 0.3 * FILL * gleam(n, v, FILL_FROM, rough);
#ifndef THRIFTY
  lamps += 0.7 * RIM * gleam(n, v, RIM_FROM, rough);
#endif
  // what is mirrored at a flat angle from below is mostly the body itself
  float up = reflect(-v, n).y;
  return 0.5 * SHINE * gloss * lamps + GLOSS * fresnel(n, v, rough) * smoothstep(-0.6, 0.6, up) * mix(GROUND, SKY, 0.5 + 0.5 * up);
}

#endif

void main() {
  vec4 base = tint;
#ifdef HAS_MAP
  vec4 texel = texture(map, place);
  base *= vec4(linear(texel.rgb), texel.a);
#endif
  float gloss = 1.0;
#if defined(SKIN) && defined(HAS_MAP)
  // what is darker than the skin round it, hair or a crease, shines less
  float around = linear(texture(map, place, 6.0).rgb).g;
  gloss = clamp(1.6 * texel.g * texel.g / max(around, 0.001) - 0.6, 0.1, 1.0);
#endif
  vec3 smoothly = normalize(facing);
#ifdef HAIR
  vec3 across, strands;
  along(smoothly, across, strands);
#else
  if (!gl_FrontFacing) smoothly = -smoothly;
#endif
  vec3 n = smoothly;
  float rough = max(0.08, roughness);
#ifdef HAS_NORMAL
  vec4 fine = relief(n);
  n = fine.xyz;
  rough = min(1.0, sqrt(rough * rough + fine.w));
#endif
  // only now: what looks at neighbouring pixels is done
#ifdef CUTOFF
  if (base.a < CUTOFF) discard;
  base.a = 1.0;
#endif
  vec3 v = normalize(cameraPosition - at);
  float open = room.w;
  // where the surface turns from the lamp its own shadow is the shading's business, not the shadow map's
  float nl = dot(smoothly, KEY_FROM);
  float key = mix(1.0, lit(), smoothstep(-0.15, 0.1, nl));
#if defined(MIRROR)
  vec3 shining = open * reflected(n, v, rough, key);
#elif defined(HAIR)
  vec3 shining = strandsGleam(n, v, strands, base.rgb, rough, key);
#else
  vec3 shining = open * glossed(n, v, rough, key, gloss);
#endif
  vec3 light = base.rgb * (room.rgb + open * diffused(n, nl, key)) + shining;
#ifdef CLEAR
  float glare = clamp(max(shining.r, max(shining.g, shining.b)), 0.0, 1.0);
  float cover = base.a + (1.0 - base.a) * glare;
  light = mix(shining, light, base.a) / max(cover, 0.001);
  base.a = cover;
#endif
  color = vec4(srgb(film(light)), base.a);
}
