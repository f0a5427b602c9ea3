// Whether two pixels see one surface. At reduced resolution the samples stand for some of the pixels.

// Full-resolution pixel that low-resolution sample i stands for.
ivec2 pn_sample_pixel(ivec2 i) { return min(i * pn_offset.z + pn_offset.w, pn_view.zw - 1); }

// How far apart neighbouring pixels are on a surface that faces the camera.
float pn_pixel_size(ivec2 pixel, pn_Surface s) {
  return length(pn_point(pixel + ivec2(1, 0), pn_depth_at(pixel)) - s.p);
}

bool pn_same_surface(pn_Surface s, ivec2 other, float pixel_size) {
  if (!pn_receives(other)) return false;
  pn_Surface o = pn_surface(other);
  vec3 d = o.p - s.p;
  float lateral = length(d);
  // Half a pixel of height over the block's width: what a gently curved surface has, and a step has not.
  float slack = 0.5 * pixel_size + dot(abs(s.n), s.error + o.error) + (s.sigma + o.sigma) * lateral;
  return abs(dot(s.n, d)) <= slack && dot(s.n, o.n) > 0.9;
}
