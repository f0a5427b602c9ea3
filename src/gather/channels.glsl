// Visibility in as many channels as the light emits in: one, so far. What follows is all that depends on their number.
#define pn_Visibility float

// The largest of the channels.
float pn_largest(pn_Visibility v) { return v; }
vec4 pn_visibility_texel(pn_Visibility v) { return vec4(v); }
pn_Visibility pn_visibility_of(vec4 texel) { return texel.r; }
