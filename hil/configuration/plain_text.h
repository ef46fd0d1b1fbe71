// Text that comes from outside, as the rooms of this folder call it (protocols/plain_text.h).
#pragma once

#include "protocols/plain_text.h"

namespace rigwire::hil {

using protocols::Character;
using protocols::find_fault;
using protocols::first_character;
using protocols::printable;
using protocols::TextFault;
using protocols::TextShape;

}  // namespace rigwire::hil
