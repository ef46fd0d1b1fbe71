// The smallest machine there is: tests of contact and benchmarks share it.
#pragma once

#include "bench/free_body.h"
