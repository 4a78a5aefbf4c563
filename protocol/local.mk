noinst_LIBRARIES += protocol/libgprotocol.a
protocol_libgprotocol_a_SOURCES = \
	protocol/key.h \
	protocol/master.h \
	protocol/node.h \
	protocol/params.def protocol/params.h
protocol_libgprotocol_a_CFLAGS = $(AM_CFLAGS) $(SODIUM_CFLAGS) $(LZO_CFLAGS)
