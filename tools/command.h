/*
 * The commands of `grotto`: one file each, one table in tools/grotto.c.
 * argv[0] is the command's name; the value returned is the exit status
 * (enum gr_exit): 0 done, 1 it failed, 2 what was given is wrong.
 */
#ifndef GROTTO_TOOLS_COMMAND_H
#define GROTTO_TOOLS_COMMAND_H

int command_bake(int argc, char **argv);
int command_bench(int argc, char **argv);
int command_check(int argc, char **argv);
int command_demo(int argc, char **argv);
int command_doctor(int argc, char **argv);
int command_faults(int argc, char **argv);
int command_key(int argc, char **argv);
int command_record(int argc, char **argv);
int command_reference(int argc, char **argv);
int command_replay(int argc, char **argv);
int command_render(int argc, char **argv);
int command_status(int argc, char **argv);
int command_trackers(int argc, char **argv);

#endif
