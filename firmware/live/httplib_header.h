// cpp-httplib's header without the macro that Eigen's headers cannot stand.
#pragma once

#include <httplib.h>

// <resolv.h>, which <httplib.h> includes, defines this name as a macro.
#undef _res
