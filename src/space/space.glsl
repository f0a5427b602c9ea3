// Light map space (s, t, w): the same functions as in space.h, under the same names. docs/space.md derives them.

vec3 pn_map_point(vec3 p, bool sun) { return sun ? vec3(p.xy, -p.z) : vec3(p.xy, 1.0) / p.z; }

vec3 pn_light_point(vec3 m, bool sun) { return sun ? vec3(m.xy, -m.z) : vec3(m.xy, 1.0) / m.z; }

vec2 pn_back_project(vec3 q, vec3 r) { return (q.xy - r.xy) / (q.z - r.z); }

float pn_plane_offset(vec3 n, vec3 p, bool sun) { return sun ? n.z : dot(n, p); }

float pn_plane_front(vec3 n, float k, vec3 q, vec3 r) { return dot(n.xy, q.xy - r.xy) - k * (q.z - r.z); }

float pn_horizon(vec3 n, float k, vec2 light_point) { return dot(n.xy, light_point) - k; }

vec2 pn_search_window(vec2 extent, float w_max, float w_r) { return extent * max(w_max - w_r, 0.0); }

vec2 pn_penumbra_extent(vec2 extent, float w, float w_min) { return extent * max(w - w_min, 0.0); }
