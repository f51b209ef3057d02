#pragma once

#include "adaptiso/Core/Numbers.h"  // IWYU pragma: export
