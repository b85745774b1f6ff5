#include "umat/in/host_pool.hpp"

#include <mutex>
#include <vector>

namespace repose::umat {
namespace {

/// Ends its processes with the program.
class HostPool {
 public:
  static HostPool& instance() {
    static HostPool only;
    return only;
  }
  std::unique_ptr<HostProcess> take(const Library& library) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = waiting_.size(); i-- > 0;)
      if (waiting_[i]->library() == library) {
        std::unique_ptr<HostProcess> found = std::move(waiting_[i]);
        waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
        return found;
      }
    return nullptr;
  }
  void give_back(std::unique_ptr<HostProcess> process) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(process));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<HostProcess>> waiting_;
};

}  // namespace

HostLease::HostLease(const Library& library) : process_(HostPool::instance().take(library)) {
  if (!process_) process_ = std::make_unique<HostProcess>(library);
}

HostLease::~HostLease() {
  if (process_ && process_->alive()) HostPool::instance().give_back(std::move(process_));
}

}  // namespace repose::umat
