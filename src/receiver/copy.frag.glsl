// Sample 0 of a multisample depth texture, into a depth texture of our own. Desktop GL only: ES 3.00 has no such
// sampler.
uniform sampler2DMS pn_samples;
uniform ivec4 pn_view;

void main() { gl_FragDepth = texelFetch(pn_samples, pn_view.xy + ivec2(gl_FragCoord.xy), 0).r; }
