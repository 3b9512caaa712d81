#version 300 es
// A point of a body or tool: where it is, its outside, and the value of the field there with whether there is one.
in vec3 position;
in vec3 normal;
in vec2 value;
uniform mat4 pose;
uniform mat4 camera;
out vec3 place;
out vec3 outside;
out vec2 level;

void main() {
  vec4 world = pose * vec4(position, 1.0);
  place = world.xyz;
  outside = mat3(pose) * normal;
  level = value;
  gl_Position = camera * world;
}
