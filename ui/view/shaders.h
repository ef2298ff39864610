// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

namespace dubsar::ui {

/// Whether element k is marked in words that lie as BitMarks has them.
inline constexpr const char* kIsMarked = R"glsl(
bool is_marked(usamplerBuffer words, int k) {
  return (texelFetch(words, (k >> 10) * 32 + (k & 31)).r >> (k >> 5 & 31) & 1u) != 0u;
}
)glsl";

/// Vertices of surface and points. What the picture does not ask for is not carried to its pixels: where
/// faces are smaller than those, that is half the time.
inline constexpr const char* kSurfaceVertex = R"glsl(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 traits;   // openness, reliability, scans / 255, flags / 255
uniform mat4 clip_from_model;
uniform mat3 eye_from_model;
out vec3 eye_normal;
out float openness;
#ifdef EVERYTHING
layout(location = 3) in float value;
layout(location = 4) in vec3 colour;
uniform float point_px;
uniform float towards_viewer;   // in clip depth
uniform int overlay;
uniform vec2 value_range;
uniform int selection;            // 2: vertices that are selected are told apart
uniform usamplerBuffer selected;  // vertices
out vec3 eye_position;
out vec3 paint;                   // what the overlay shows: a colour, flags, or a part of the colour map
out float vertex_selected;
vec3 painted() {
  if (overlay == 1) {
    return colour;
  }
  if (overlay == 5) {
    int flags = int(traits.w * 255.0 + 0.5);
    return vec3(float(flags & 1), float((flags >> 1) & 1), 0.0);   // sparse, interpolated
  }
  return vec3(overlay == 2   ? (value - value_range.x) / max(value_range.y - value_range.x, 1e-20)
              : overlay == 3 ? traits.y
                             : traits.z * 255.0 / 8.0,
              0.0, 0.0);
}
#endif
void main() {
  gl_Position = clip_from_model * vec4(position, 1.0);
  eye_normal = eye_from_model * normal;
  openness = traits.x;
#ifdef EVERYTHING
  gl_Position.z -= towards_viewer;
  gl_PointSize = point_px;
  eye_position = eye_from_model * position;
  paint = painted();
  vertex_selected = selection == 2 && is_marked(selected, gl_VertexID) ? 1.0 : 0.0;
#endif
}
)glsl";

/// What is seen where: colour and openness, and the way the surface looks.
inline constexpr const char* kSurfaceFragment = R"glsl(
in vec3 eye_normal;
in float openness;
uniform vec3 clay;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 surface;
#ifdef EVERYTHING
in vec3 eye_position;
in vec3 paint;
in float vertex_selected;
uniform int overlay;        // 0 clay, 1 own colours, 2 value, 3 reliability, 4 scans, 5 flags
uniform int flat_shading;
uniform int marks;          // 1: points of red and amber, 2: points of a mesh without faces
uniform vec3 red;
uniform vec3 amber;
uniform sampler2D colour_map;
uniform int selection;            // faces that are selected are told apart: 1, of the whole surface; 3, by
uniform int first_face;           // the one that each was made of. Counted from the first of this draw
uniform usamplerBuffer selected;  // faces
uniform usamplerBuffer made_of;
uniform vec3 selected_colour;

vec3 painted() {
  if (overlay == 1) {
    return paint;
  }
  if (overlay == 5) {
    return paint.x > 0.5 ? red : paint.y > 0.5 ? amber : clay;
  }
  return texture(colour_map, vec2(clamp(paint.x, 0.002, 0.998), 0.5)).rgb;
}

bool is_selected() {
  int face = first_face + gl_PrimitiveID;
  if (selection == 3) {
    face = int(texelFetch(made_of, face).r);
  }
  return vertex_selected > 0.5 || ((selection & 1) != 0 && is_marked(selected, face));
}
#endif
void main() {
  vec3 n = eye_normal;
  bool facing_known = dot(n, n) > 0.01;
  vec3 c = clay;
#ifdef EVERYTHING
  if (marks != 0) {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    if (dot(at, at) > 1.0 || (facing_known && n.z < 0.0)) {
      discard;
    }
  }
  if (marks == 1) {
    albedo = vec4(mix(red, amber, openness), 1.0);
    surface = vec4(facing_known ? normalize(n) : vec3(0.0, 0.0, 1.0), 0.5);
    return;
  }
  if (marks == 0 && (flat_shading != 0 || !facing_known)) {
    n = cross(dFdx(eye_position), dFdy(eye_position));
    facing_known = dot(n, n) > 0.0;
  }
  if (overlay != 0) {
    c = painted();
  }
  if (is_selected()) {
    c = mix(c, selected_colour, 0.65);
  }
  bool may_be_inside = marks == 0;
#else
  const bool may_be_inside = true;
#endif
  n = facing_known ? normalize(n) : vec3(0.0, 0.0, 1.0);
  // The inside of the clay, seen through a hole.
  if (n.z < 0.0 && may_be_inside) {
    n = -n;
    c = vec3(0.30, 0.32, 0.36);
  }
  albedo = vec4(c, openness);
  surface = vec4(n, 1.0);
}
)glsl";

/// Of what casts shadows.
inline constexpr const char* kShadowVertex = R"glsl(#version 410 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_model;
void main() { gl_Position = clip_from_model * vec4(position, 1.0); }
)glsl";

inline constexpr const char* kShadowFragment = R"glsl(#version 410 core
void main() {}
)glsl";

/// A triangle that covers the picture.
inline constexpr const char* kPictureVertex = R"glsl(#version 410 core
out vec2 at;
void main() {
  at = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
}
)glsl";

/// Light on what is seen: lit sphere (Sloan et al. 2001), radiance scaling (Vergne et al. 2010), ambient
/// occlusion, depth shading, and a raking lamp with shadows.
inline constexpr const char* kLightFragment = R"glsl(#version 410 core
in vec2 at;
uniform sampler2D albedo_map;
uniform sampler2D surface_map;
uniform sampler2D depth_map;
uniform sampler2D sphere_map;
uniform sampler2D shadow_map;
uniform int lamp;             // 0: lit sphere, 1: raking lamp
uniform vec3 light;           // towards the lamp, eye space, unit
uniform int shadows;
uniform float shadow_slack;   // of clip depth
uniform int occlusion;
uniform float radiance;       // 0: off
uniform float depth_shading;  // 0: off
uniform mat4 light_clip_from_clip;
uniform vec4 ground;
uniform vec2 px;              // size of a pixel in [0, 1]
uniform float mm_per_px;
uniform float depth_mm;
out vec4 colour;

vec4 surface_at(vec2 p) { return texture(surface_map, p); }

// Apparent curvature from the change of the normal, squashed; nothing across a silhouette.
float curvature() {
  vec4 l = surface_at(at - vec2(px.x, 0.0));
  vec4 r = surface_at(at + vec2(px.x, 0.0));
  vec4 d = surface_at(at - vec2(0.0, px.y));
  vec4 u = surface_at(at + vec2(0.0, px.y));
  if (l.w < 0.9 || r.w < 0.9 || d.w < 0.9 || u.w < 0.9) {
    return 0.0;
  }
  float zl = texture(depth_map, at - vec2(px.x, 0.0)).r;
  float zr = texture(depth_map, at + vec2(px.x, 0.0)).r;
  float zd = texture(depth_map, at - vec2(0.0, px.y)).r;
  float zu = texture(depth_map, at + vec2(0.0, px.y)).r;
  float jump = (abs(zl - zr) + abs(zd - zu)) * 2.0 * depth_mm / mm_per_px;
  float fade = 1.0 - smoothstep(6.0, 16.0, jump);
  float bend = (r.x - l.x) + (u.y - d.y);   // above 0 where convex
  return fade * tanh(bend * 2.0);
}

float scaling(float shade, float kappa) {
  float a = 0.1;
  float e = exp(-radiance * kappa);
  return (a * e + shade * (1.0 - a - a * e)) / (a + shade * (e - a - a * e));
}

float lit() {
  float z = texture(depth_map, at).r;
  vec4 p = light_clip_from_clip * vec4(2.0 * at - 1.0, 2.0 * z - 1.0, 1.0);
  vec3 q = 0.5 * p.xyz + 0.5;
  vec2 texel = 1.0 / vec2(textureSize(shadow_map, 0));
  float open = 0.0;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      open += texture(shadow_map, q.xy + vec2(i, j) * texel).r + shadow_slack > q.z ? 1.0 : 0.0;
    }
  }
  return open / 9.0;
}

void main() {
  vec4 s = surface_at(at);
  vec4 a = texture(albedo_map, at);
  if (s.w < 0.25) {
    colour = ground;
    return;
  }
  vec3 n = normalize(s.xyz);
  float open = occlusion != 0 ? mix(0.25, 1.0, a.a) : 1.0;
  if (s.w < 0.75) {   // red and amber marks stay what they are
    colour = vec4(a.rgb * (0.75 + 0.25 * n.z), 1.0);
    return;
  }
  vec3 c;
  float kappa = radiance > 0.0 ? curvature() : 0.0;
  if (lamp == 0) {
    vec3 sphere = texture(sphere_map, 0.5 + 0.49 * n.xy).rgb;
    c = a.rgb * sphere * 1.06;
    if (radiance > 0.0) {
      c *= scaling(clamp(length(sphere) / 1.74, 0.05, 0.95), kappa);
    }
  } else {
    float shade = clamp(dot(n, light), 0.0, 1.0);
    if (shadows != 0 && shade > 0.0) {
      shade *= lit();
    }
    float d = clamp(shade, 0.02, 0.98);
    float with = radiance > 0.0 ? shade * scaling(d, kappa) : shade;
    c = a.rgb * (0.07 + 1.10 * with);
  }
  if (depth_shading > 0.0) {
    float z = texture(depth_map, at).r;
    float mean = 0.0;
    for (int i = -2; i <= 2; ++i) {
      for (int j = -2; j <= 2; ++j) {
        float there = texture(depth_map, at + vec2(i, j) * px * 5.0).r;
        mean += there < 1.0 ? there : z;   // beside the tablet there is nothing to stand out from
      }
    }
    float deeper = (z - mean / 25.0) * 2.0 * depth_mm;   // mm below what is around
    c *= clamp(1.0 - depth_shading * deeper, 0.35, 1.5);
  }
  colour = vec4(c * open, 1.0);
}
)glsl";

}  // namespace dubsar::ui
