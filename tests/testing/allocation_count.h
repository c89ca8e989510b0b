// Counts what an executable takes from the heap.
//
// Whoever links gelenk_allocation_count has every malloc of the code linked
// into it counted (Eigen's too, by the linker's --wrap), and every operator
// new.
#ifndef GELENK_TESTS_TESTING_ALLOCATION_COUNT_H_
#define GELENK_TESTS_TESTING_ALLOCATION_COUNT_H_

namespace gelenk::testing {

// Since the executable started.
int AllocationCount();

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_ALLOCATION_COUNT_H_
