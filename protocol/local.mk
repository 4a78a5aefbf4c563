noinst_LIBRARIES += protocol/libgprotocol.a
protocol_libgprotocol_a_SOURCES = \
	protocol/barrier.h \
	protocol/bucket.h \
	protocol/clock_offset.c protocol/clock_offset.h \
	protocol/delta.c \
	protocol/fragment.c protocol/fragment.h \
	protocol/glance.c protocol/glance.h \
	protocol/input.c protocol/input.h \
	protocol/joints.c protocol/joints.h \
	protocol/key.c protocol/key.h \
	protocol/loss.h \
	protocol/master.c protocol/master.h protocol/master_private.h \
	protocol/master_bulk.c \
	protocol/master_clock.c \
	protocol/master_follow.c \
	protocol/master_join.c \
	protocol/master_pace.c \
	protocol/master_parity.c \
	protocol/master_receive.c \
	protocol/master_refuse.c \
	protocol/master_repair.c \
	protocol/master_share.c \
	protocol/master_way.c \
	protocol/master_window.c \
	protocol/message.c protocol/message.h \
	protocol/node.c protocol/node.h protocol/node_private.h \
	protocol/node_call.c \
	protocol/node_clock.c \
	protocol/node_frame.c \
	protocol/node_glance.c \
	protocol/node_input.c \
	protocol/node_share.c \
	protocol/node_vitals.c \
	protocol/outbox.c protocol/outbox.h \
	protocol/pack.c protocol/pack.h \
	protocol/pace.c protocol/pace.h \
	protocol/parity.c protocol/parity.h \
	protocol/params.c protocol/params.def protocol/params.h protocol/state.h \
	protocol/peer.c protocol/peer.h \
	protocol/replay.h \
	protocol/share.c protocol/share.h \
	protocol/standby.c protocol/standby.h \
	protocol/trip.h \
	protocol/session_keys.c protocol/session_keys.h \
	protocol/vitals.c protocol/vitals.h \
	protocol/window.h \
	protocol/wire.c protocol/wire.h
protocol_libgprotocol_a_CFLAGS = $(AM_CFLAGS) $(SODIUM_CFLAGS) $(LZO_CFLAGS) $(ISAL_CFLAGS) $(XXHASH_CFLAGS)
