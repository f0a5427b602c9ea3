/* streams.h: standard streams that are closed. */
#ifndef PENUMBRA_APP_BASE_STREAMS_H
#define PENUMBRA_APP_BASE_STREAMS_H

/* Holds their places, so that no file that is opened later gets a stream's number and what is printed. Writing to such
 * a stream fails, as to a closed one. */
void streams_hold(void);

#endif
