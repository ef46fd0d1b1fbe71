#include "drivers/descriptor.h"

#include <fcntl.h>
#include <gtest/gtest.h>

namespace rigwire::drivers {
namespace {

bool is_open(int descriptor) {
  return ::fcntl(descriptor, F_GETFD) != -1;
}

TEST(Descriptor, IsClosedAtTheEndOfItsScope) {
  int number = -1;
  {
    const Descriptor null(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    ASSERT_TRUE(null.open());
    number = null.get();
    EXPECT_TRUE(is_open(number));
  }
  EXPECT_FALSE(is_open(number));
}

TEST(Descriptor, ReleasedOneStaysOpenAndIsTheCallers) {
  int number = -1;
  {
    Descriptor null(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    number = null.release();
    EXPECT_FALSE(null.open());
  }
  EXPECT_TRUE(is_open(number));
  const Descriptor closes_it(number);
}

TEST(Descriptor, FailedCallOwnsNothing) {
  const Descriptor none(::open("/dev/there is no such device", O_RDONLY));
  EXPECT_FALSE(none.open());
}

}  // namespace
}  // namespace rigwire::drivers
