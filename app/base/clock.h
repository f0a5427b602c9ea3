/* clock.h: the monotonic clock. */
#ifndef PENUMBRA_APP_BASE_CLOCK_H
#define PENUMBRA_APP_BASE_CLOCK_H

double clock_ms(void);

#endif
