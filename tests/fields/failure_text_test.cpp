#include "fields/failure_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

namespace rigwire::fields {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(FailureText, ExhaustedMemoryNamesWhatWasMadeAndTheRemedy) {
  EXPECT_THAT(failure_text(std::bad_alloc(), "the run of pit"),
              AllOf(HasSubstr("no memory left for the run of pit"), HasSubstr("ulimit -v"),
                    Not(HasSubstr("bad_alloc"))));
  EXPECT_THAT(failure_text(std::length_error("vector"), "a picture"), HasSubstr("a picture"));
  EXPECT_EQ(failure_text(std::runtime_error("the disc is full"), "a picture"), "the disc is full");
}

}  // namespace
}  // namespace rigwire::fields
