// Navigation messages (class 0x01) of u-blox 7, 8 and 9, all of them.
#pragma once

#include "protocols/ubx/navigation_precise.h"
#include "protocols/ubx/navigation_pvt.h"
#include "protocols/ubx/navigation_satellites.h"
#include "protocols/ubx/navigation_solution.h"
#include "protocols/ubx/navigation_time.h"
