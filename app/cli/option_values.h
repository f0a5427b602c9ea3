/* option_values.h: reading one option's value. Each reader takes the option's name for its message, and answers
 * with the exit status. */
#ifndef PENUMBRA_APP_CLI_OPTION_VALUES_H
#define PENUMBRA_APP_CLI_OPTION_VALUES_H

/* Exactly count comma-separated finite numbers. shape: how it should look, for the message: "X,Y,Z". */
int read_numbers(const char *name, const char *text, int count, const char *shape, double *out);

/* A whole number within least and most. */
int read_integer(const char *name, const char *text, int least, int most, int *out);

/* "WxH", both within least and most; square: "N" alone stands for N x N. */
int read_size(const char *name, const char *text, int least, int most, int square, int out[2]);

/* One word of a NULL-terminated list, by its index. */
int read_choice(const char *name, const char *text, const char *const *choices, int *out);

#endif
