#version 300 es
// A face or line: cut off behind a plane, coloured by a field or plain, lit from the eye.
precision highp float;
in vec3 place;
in vec3 outside;
in vec2 level;
uniform vec4 cut;
uniform vec3 eye;
uniform vec4 plain;
uniform vec3 nothing;
// 0: lines, 1: plain faces with normals of their own, 2: flat faces with a field, 3: flat faces without.
uniform int kind;
uniform sampler2D colours;
out vec4 colour;

void main() {
  if (dot(cut.xyz, place) > cut.w) discard;
  if (kind == 0) {
    colour = plain;
    return;
  }
  vec3 flat_normal = cross(dFdx(place), dFdy(place));
  vec3 normal = kind == 1 && dot(outside, outside) > 0.1 ? normalize(outside) : normalize(flat_normal);
  vec3 base = plain.rgb;
  if (kind == 2) base = level.y > 0.999 ? texture(colours, vec2(level.x * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb : nothing;
  float light = 0.62 + 0.38 * abs(dot(normal, normalize(eye - place)));
  // Seen from inside, through the cut.
  if (!gl_FrontFacing && kind != 1) light *= 0.6;
  colour = vec4(base * light, plain.a);
}
