// Bit fields over the light (Schwarz and Stamminger 2007, section 3): each bit is one sample point, set where
// something hides it. Coordinates run from 0 to 1 over the light. PN_SAMPLES: 8, 16, 32 for regular grids of that
// many points a side, 17 for 16 x 16 jittered.
//
// Sample (i, j) of a regular grid lies at (i + 1/2, j + 1/2) / N. The jittered grid tiles the rotated-grid pattern of
// 2 x 2 points: its offset along x depends on the row's parity alone, along y on the column's: (3/4 or 1/4, 1/4 or
// 3/4). So rectangles stay products of ranges.

#if PN_SAMPLES == 17
#define PN_GRID 16
#else
#define PN_GRID PN_SAMPLES
#endif

// Words: 8 x 8 keeps four rows in each of two words, 16 x 16 two rows in each of eight, 32 x 32 one row in each of 32.
// Within a word the bits of a column stand together, so that a rectangle's part of any word is the same columns and a
// repeated group of lines: 8: bit 4 i + j % 4 (lines are rows), 16: 2 i + j % 2, 16j: 4 (i / 2) + 2 (j % 2) + i % 2
// (two lines a row: its even columns, its odd ones), 32: i.
#if PN_GRID == 8
#define PN_WORDS 1
#define PN_LINES 4
#define PN_REPEAT 0x11111111u
#elif PN_SAMPLES == 17
#define PN_WORDS 2
#define PN_LINES 4
#define PN_REPEAT 0x11111111u
#elif PN_GRID == 16
#define PN_WORDS 2
#define PN_LINES 2
#define PN_REPEAT 0x55555555u
#else
#define PN_WORDS 8
#define PN_LINES 1
#define PN_REPEAT 0xffffffffu
#endif

struct pn_Field { uvec4 bits[PN_WORDS]; };

// Bits from first up to, not including, last; 0 <= first, last <= 32.
uint pn_bit_range(int first, int last) {
  return last > first ? (0xffffffffu >> uint(32 - (last - first))) << uint(first) : 0u;
}

// Samples along one axis whose coordinates, at offset in their cells, lie in [low, high).
uint pn_sample_range(float low, float high, float offset) {
  ivec2 ends = ivec2(clamp(ceil(vec2(low, high) * float(PN_GRID) - offset), 0.0, float(PN_GRID)));
  return pn_bit_range(ends.x, ends.y);
}

// Lines (a bit for each) to the words of the field: all columns of those.
uvec4 pn_spread_lines(uint lines, int word) {
#if PN_GRID == 8
  return uvec4((uvec2(lines) >> uvec2(0u, 4u) & 15u) * PN_REPEAT, 0u, 0u);
#else
  uvec4 shift = uvec4(0u, 1u, 2u, 3u) * uint(PN_LINES) + uint(4 * PN_LINES * word);
  return (uvec4(lines) >> shift & ((1u << uint(PN_LINES)) - 1u)) * PN_REPEAT;
#endif
}

// One row's columns, a bit for each, to their places in its word.
uint pn_spread_columns(uint columns, int row) {
#if PN_GRID == 8
  columns = (columns | columns << 12) & 0x000f000fu;
  columns = (columns | columns << 6) & 0x03030303u;
  return ((columns | columns << 3) & 0x11111111u) << uint(row & 3);
#elif PN_GRID == 16
  columns = (columns | columns << 8) & 0x00ff00ffu;
  columns = (columns | columns << 4) & 0x0f0f0f0fu;
  columns = (columns | columns << 2) & 0x33333333u;
#if PN_SAMPLES == 17
  return columns << uint(2 * (row & 1));
#else
  return ((columns | columns << 1) & 0x55555555u) << uint(row & 1);
#endif
#else
  return columns;
#endif
}

uint pn_lines_of_row(int row) {
#if PN_SAMPLES == 17
  return 3u << uint(2 * row);
#else
  return 1u << uint(row);
#endif
}

const uint pn_even_columns = 0x55555555u;

// The samples inside a rectangle. The displaced samples' coordinates, all of them together, are those of a regular
// grid of 32: along y sample (i, j) is at 2 j + i % 2, which is its line; along x at 2 i + (j + 1) % 2. So there too
// each axis is one range.
pn_Field pn_rectangle(vec2 low, vec2 high) {
  pn_Field f;
#if PN_SAMPLES == 17
  ivec4 ends = ivec4(clamp(ceil(vec4(low, high) * 32.0 - 0.5), 0.0, 32.0));
  uint found = pn_bit_range(ends.x, ends.z), lines = pn_bit_range(ends.y, ends.w);
  // from 4 (i / 2) + 2 (i % 2) + (j + 1) % 2 to the places in a word
  uint columns = found >> 1 & 0x11111111u | found >> 2 & 0x22222222u | found << 2 & 0x44444444u |
                 found << 1 & 0x88888888u;
#else
  ivec4 ends = ivec4(clamp(ceil(vec4(low, high) * float(PN_GRID) - 0.5), 0.0, float(PN_GRID)));
  uint columns = pn_bit_range(ends.x * PN_LINES, ends.z * PN_LINES), lines = pn_bit_range(ends.y, ends.w);
#endif
  for (int i = 0; i < PN_WORDS; i++) f.bits[i] = columns & pn_spread_lines(lines, i);
  return f;
}

// Ends, along x, of a convex polygon's slice at y, gathered edge by edge; edges are always taken upwards, so that two
// polygons that share one find the same crossing and neither gap nor overlap is left between them.
void pn_slice(inout vec2 ends, vec2 a, vec2 b, float y) {
  if (b.y < a.y) {
    vec2 swap = a;
    a = b;
    b = swap;
  }
  if (!(a.y <= y && y < b.y)) return;
  float x = a.x + (y - a.y) * ((b.x - a.x) / (b.y - a.y));
  ends = vec2(min(ends.x, x), max(ends.y, x));
}

uint pn_triangle_row(vec2 a, vec2 b, vec2 c, float y, float offset) {
  vec2 ends = vec2(2.0, -2.0);
  pn_slice(ends, a, b, y);
  pn_slice(ends, b, c, y);
  pn_slice(ends, c, a, y);
  return ends.x < ends.y ? pn_sample_range(ends.x, ends.y, offset) : 0u;
}

// First row, and the one after the last, that have samples between two heights.
ivec2 pn_rows_between(float low, float high) {
  return ivec2(clamp(ceil(vec2(low * float(PN_GRID) - 0.75, high * float(PN_GRID) - 0.25)), 0.0, float(PN_GRID)));
}

// Adds the samples of row j inside a triangle.
void pn_add_triangle_row(inout pn_Field f, vec2 a, vec2 b, vec2 c, int j) {
#if PN_SAMPLES == 17
  float offset = (j & 1) == 0 ? 0.75 : 0.25;
  uint columns = pn_triangle_row(a, b, c, (float(j) + 0.25) / 16.0, offset) & pn_even_columns |
                 pn_triangle_row(a, b, c, (float(j) + 0.75) / 16.0, offset) & ~pn_even_columns;
#else
  uint columns = pn_triangle_row(a, b, c, (float(j) + 0.5) / float(PN_GRID), 0.5);
#endif
  uint spread = pn_spread_columns(columns, j), lines = pn_lines_of_row(j);
  for (int i = 0; i < PN_WORDS; i++) f.bits[i] |= spread & pn_spread_lines(lines, i);
}

// Adds the samples inside a triangle, row by row.
void pn_add_triangle(inout pn_Field f, vec2 a, vec2 b, vec2 c) {
  ivec2 rows = pn_rows_between(min(a.y, min(b.y, c.y)), max(a.y, max(b.y, c.y)));
  for (int j = rows.x; j < rows.y; j++) pn_add_triangle_row(f, a, b, c, j);
}

pn_Field pn_field_empty() {
  pn_Field f;
  for (int i = 0; i < PN_WORDS; i++) f.bits[i] = uvec4(0u);
  return f;
}

uvec4 pn_count_bits(uvec4 v) {
  v = v - ((v >> 1u) & 0x55555555u);
  v = (v & 0x33333333u) + ((v >> 2u) & 0x33333333u);
  return (((v + (v >> 4u)) & 0x0f0f0f0fu) * 0x01010101u) >> 24u;
}

float pn_field_count(pn_Field f) {
  uvec4 sum = uvec4(0u);
  for (int i = 0; i < PN_WORDS; i++) sum += pn_count_bits(f.bits[i]);
  return float(sum.x + sum.y + sum.z + sum.w);
}

// The samples above the receiver's horizon: where horizon = x x_L + y y_L - k is positive, x_L and y_L on the light.
pn_Field pn_field_horizon(vec2 extent, vec2 n, float k) {
  pn_Field f = pn_field_empty();
  vec2 slope = 2.0 * extent * n;               // in coordinates from 0 to 1
  float at = k + dot(extent, n);               // slope . p > at
  for (int j = 0; j < PN_GRID; j++) {
    uint columns = 0u;
    for (int i = 0; i < PN_GRID; i++) {
#if PN_SAMPLES == 17
      vec2 p = vec2(float(i) + ((j & 1) == 0 ? 0.75 : 0.25), float(j) + ((i & 1) == 0 ? 0.25 : 0.75)) / 16.0;
#else
      vec2 p = (vec2(i, j) + 0.5) / float(PN_GRID);
#endif
      columns |= dot(slope, p) > at ? 1u << uint(i) : 0u;
    }
    uint spread = pn_spread_columns(columns, j), lines = pn_lines_of_row(j);
    for (int w = 0; w < PN_WORDS; w++) f.bits[w] |= spread & pn_spread_lines(lines, w);
  }
  return f;
}
