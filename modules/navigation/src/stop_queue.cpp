#include "stop_queue.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "foucault/core/time.h"

namespace foucault::navigation {

int64_t stamp(const StopEvent& event) {
  return std::visit([](const auto& e) { return e.t_ns; }, event);
}

StopQueue::StopQueue(double node_interval) : node_interval_ns_(nanoseconds(node_interval)) {}

void StopQueue::start(int64_t t_ns) {
  last_node_ns_ = t_ns;
  pending_.erase(pending_.begin(), pending_.lower_bound(t_ns));
}

void StopQueue::add(const StopEvent& event) { pending_.emplace(stamp(event), event); }

std::optional<int64_t> StopQueue::next(int64_t now_ns, int64_t end_ns) const {
  int64_t stop_ns = std::max(hold_due_ns(), now_ns + 1);
  if (!pending_.empty()) stop_ns = std::min(stop_ns, pending_.begin()->first);
  if (stop_ns > end_ns) return std::nullopt;
  return stop_ns;
}

std::optional<StopEvent> StopQueue::take_due(int64_t now_ns) {
  if (pending_.empty() || pending_.begin()->first > now_ns) return std::nullopt;
  return std::move(pending_.extract(pending_.begin()).mapped());
}

/// A fix expected about when the hold is due is waited for: stamps that jitter must not make pairs
/// of nodes a millisecond apart.
int64_t StopQueue::hold_due_ns() const {
  const int64_t due_ns = last_node_ns_ + node_interval_ns_;
  if (!last_fix_ns_ || fix_interval_ns_ == 0) return due_ns;
  const int64_t grace_ns = node_interval_ns_ / 20;
  const int64_t off_ns = std::abs(*last_fix_ns_ + fix_interval_ns_ - due_ns);
  const bool jitter = off_ns > 1000 && off_ns < grace_ns;
  return jitter ? due_ns + grace_ns : due_ns;
}

void StopQueue::fix_used(int64_t now_ns) {
  if (last_fix_ns_) fix_interval_ns_ = now_ns - *last_fix_ns_;
  last_fix_ns_ = last_node_ns_ = now_ns;
}

double StopQueue::fix_interval() const { return 1e-9 * static_cast<double>(fix_interval_ns_); }

std::vector<GnssFix> StopQueue::pending_fixes() const {
  std::vector<GnssFix> fixes;
  for (const auto& [t_ns, event] : pending_) {
    if (const auto* fix = std::get_if<GnssFix>(&event)) fixes.push_back(*fix);
  }
  return fixes;
}

std::vector<Measurement> StopQueue::clear() {
  std::vector<Measurement> events;
  for (auto pending = pending_.begin(); pending != pending_.end();) {
    const StopEvent& event = pending->second;
    const bool stays = std::holds_alternative<Observed>(event);
    if (const auto* fix = std::get_if<GnssFix>(&event)) events.emplace_back(*fix);
    if (const auto* request = std::get_if<EpochRequest>(&event)) events.emplace_back(*request);
    pending = stays ? std::next(pending) : pending_.erase(pending);
  }
  last_fix_ns_.reset();
  fix_interval_ns_ = 0;
  return events;
}

}  // namespace foucault::navigation
