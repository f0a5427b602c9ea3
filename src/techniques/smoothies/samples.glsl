// Where over w_R the smoothies' texels are sampled: two pairs, one below every receiver, one half way up.

float pn_sample_step(int light) { return (pn_w_near(light) - pn_lights[light].w_reach) / 32.0; }

vec4 pn_samples(int light) {
  float step = pn_sample_step(light);
  return vec4(pn_lights[light].w_reach) + step * vec4(-1.0, 0.0, 15.0, 16.0);
}
