// Numbers that stand for what is none.
#define PN_NOTHING -1e30   // the w of what is not there: behind every receiver
#define PN_EVERYTHING 1e30 // its opposite
#define PN_TINY 1e-30      // what divisors are kept above

// Anything beyond a tenth of them is one of them.
bool pn_is_nothing(float w) { return w <= -1e29; }
