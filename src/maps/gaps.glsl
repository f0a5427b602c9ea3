// Gaps in depth between the samples of a quad, as the range pyramid and stack keep them over quads, in their fourth
// channel: which corners lie on one surface, and how far what is seen beside a gap is known to go on behind the nearer
// surface (docs/space.md, "Gaps in depth"). One number, exact in a float: 65536 reach + the parts, four bits a corner.
#define PN_NO_GAP 16777215.0 // every corner on one surface, without end
#define PN_ENDLESS_REACH 16711680.0 // from here on a reach has no end: 65536 times 255

float pn_pack_gaps(float reach, ivec4 parts) {
  return 65536.0 * reach + float(parts.x | parts.y << 4 | parts.z << 8 | parts.w << 12);
}

// Texels; 255: without end. Of several quads, the smallest number has the smallest reach.
float pn_gap_reach(float gaps) { return float(int(gaps) >> 16); }

// Corners on the same surface as that corner, a bit for each; the corners are (0, 0), (1, 0), (0, 1), (1, 1).
int pn_gap_part(float gaps, int corner) { return int(gaps) >> (4 * corner) & 15; }
