// Work that may be spread over the network's threads.
#pragma once

namespace bevloc {

/// Borrows a function of an index for the length of a call. Unlike std::function it never
/// allocates.
class Turn {
 public:
  template <typename Function>
  Turn(const Function& function)
      : function_(&function), call_([](const void* borrowed, int index) {
          (*static_cast<const Function*>(borrowed))(index);
        }) {}

  void operator()(int index) const { call_(function_, index); }

 private:
  const void* function_;
  void (*call_)(const void* borrowed, int index);
};

}  // namespace bevloc
