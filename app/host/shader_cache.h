/* shader_cache.h: Mesa keeps compiled shaders in a file that it maps; where that file cannot grow, touching it ends the
 * process with SIGBUS. */
#ifndef PENUMBRA_APP_HOST_SHADER_CACHE_H
#define PENUMBRA_APP_HOST_SHADER_CACHE_H

/* Tells the driver to do without its cache where there is no room for one, and hides a relative XDG_CACHE_HOME, which
 * its specification says to ignore. Call it before the first EGL call. */
void shader_cache_guard(void);

#endif
