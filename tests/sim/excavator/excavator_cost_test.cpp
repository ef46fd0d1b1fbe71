#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "allocation_counter.h"
#include "sim/excavator/excavator.h"

namespace rigwire::sim {
namespace {

TEST(ExcavatorCost, TheCounterSeesAnAllocation) {
  const auto before = rigwire::test::allocations();
  const std::vector<int> numbers(10);
  EXPECT_EQ(rigwire::test::allocations(), before + 1);
  EXPECT_EQ(numbers.size(), 10u);
}

TEST(ExcavatorCost, SteppingCommandingAndSamplingDoNotAllocate) {
  Excavator machine(ExcavatorParameters{}, Eigen::Isometry3d::Identity());
  ValveCommand command;
  command.opening = {0.4, 1.0, 1.0, -1.0};
  double sum = 0.0;
  const auto before = rigwire::test::allocations();
  for (int i = 0; i < 2000; ++i) {
    command.floating[1] = i % 300 > 250;
    machine.command(command);
    machine.set_payload_kg(i % 700);
    machine.step(std::chrono::milliseconds(5));
    sum += machine.valve_sample(machine.time()).supply_pressure_pa;
    sum += machine.link(Link::bucket).a_WL_W.x();
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace rigwire::sim
