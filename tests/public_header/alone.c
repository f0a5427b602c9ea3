#include <penumbra/penumbra.h>
/* Twice: the include guard holds. */
#include <penumbra/penumbra.h>

/* The initialiser macros expand to valid C99 of the right shape. */
extern const pn_receiver_desc receiver_defaults;
const pn_receiver_desc receiver_defaults = PN_RECEIVER_DEFAULTS;
