// The loop body that Engine::parallel_for() runs on the network's threads.
#pragma once

namespace bevloc {

/// Reference to a function `void(int index)`. The function must outlive it. Unlike std::function,
/// it never allocates.
class LoopBody {
 public:
  template <typename Function>
  LoopBody(const Function& function)
      : function_(&function), call_([](const void* called, int index) {
          (*static_cast<const Function*>(called))(index);
        }) {}

  void operator()(int index) const { call_(function_, index); }

 private:
  const void* function_;
  void (*call_)(const void* function, int index);
};

}  // namespace bevloc
