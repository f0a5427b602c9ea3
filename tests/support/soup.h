/* Triangles, flat and few: casters and receivers of test scenes. Positions are kept as the floats that GL gets. */
#ifndef TEST_SOUP_H
#define TEST_SOUP_H

#include "vector.h"

typedef struct { float p[3][3]; } triangle;
typedef struct { triangle *list; int count, capacity; } soup;

void soup_triangle(soup *s, vec a, vec b, vec c);
/* corner, corner + a, corner + a + b, corner + b */
void soup_quad(soup *s, vec corner, vec a, vec b);
/* A rectangle around a centre, half extents a and b. */
void soup_patch(soup *s, vec centre, vec a, vec b);
void soup_box(soup *s, vec min, vec max);
/* A box anywhere: its centre and three half edges, right-handed. */
void soup_block(soup *s, vec centre, vec a, vec b, vec c);
void soup_free(soup *s);

vec corner_of(const triangle *t, int i);
vec normal_of(const triangle *t); /* unit */

#endif
