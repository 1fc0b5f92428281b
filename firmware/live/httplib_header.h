// cpp-httplib's header without the macro that breaks Eigen's headers.
#pragma once

#include <httplib.h>

// <resolv.h>, which <httplib.h> includes, defines this name as a macro.
#undef _res
