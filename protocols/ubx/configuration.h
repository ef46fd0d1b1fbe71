// What a client's dialogue with a receiver needs: configuration (class 0x06), its acknowledgement
// (class 0x05) and the state of the receiver (class 0x0A).
#pragma once

#include "protocols/ubx/acknowledge.h"
#include "protocols/ubx/configuration_navigation.h"
#include "protocols/ubx/configuration_port.h"
#include "protocols/ubx/configuration_receiver.h"
#include "protocols/ubx/configuration_values.h"
#include "protocols/ubx/monitor.h"
