/*
 * One value of an option: its default, and reading it from a setting. Groups
 * and lists are options_read's. Private to config/options*.c.
 */
#ifndef GROTTO_CONFIG_OPTIONS_VALUE_H
#define GROTTO_CONFIG_OPTIONS_VALUE_H

#include "config/options.h"

/* Stores the default, or what stands for "absent". */
void option_default(struct options_reader *reader, const struct option *option, void *to);
/* Reads a setting that is there; a wrong one is reported and leaves *to as it is. */
void option_value(struct options_reader *reader, const struct option *option,
		  const config_setting_t *at, const config_setting_t *setting, void *to);

/* What a setting is, in words; and the fault that it should have been `right`. */
const char *option_found(const config_setting_t *setting);
void option_wrong_type(struct options_reader *reader, const config_setting_t *at,
		       const struct option *option, const config_setting_t *found,
		       const char *right);

#endif
