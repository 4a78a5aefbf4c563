#include "base/result.h"

const char *gr_result_name(int result)
{
	switch ((enum gr_result)result) {
	case GR_OK: return "ok";
	case GR_NOTHING: return "nothing to do";
	case GR_ERR_NOMEM: return "out of memory";
	case GR_ERR_IO: return "input/output error";
	case GR_ERR_CONFIG: return "configuration error";
	case GR_ERR_FORMAT: return "malformed data";
	case GR_ERR_AUTH: return "authentication failed";
	case GR_ERR_VERSION: return "version mismatch";
	case GR_ERR_RANGE: return "out of range";
	case GR_ERR_UNSUPPORTED: return "not supported here";
	case GR_ERR_GL: return "OpenGL error";
	case GR_ERR_TIMEOUT: return "timed out";
	case GR_ERR_STATE: return "wrong state";
	case GR_ERR_MISMATCH: return "content mismatch";
	case GR_ERR_REPLAY: return "said before";
	}
	return "unknown result";
}
