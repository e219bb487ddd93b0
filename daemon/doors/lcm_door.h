/// @file Signed commands from the network (docs/security.md).
#pragma once

#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "daemon/dispatch/dispatcher.h"
#include "daemon/doors/command_guard.h"
#include "daemon/doors/rate_limit.h"

namespace ca2 {

/// Lives in the loop's thread; whoever owns the LCM calls its handle().
class LcmDoor {
 public:
  using Handler = std::function<void(const std::string& origin, const std::string& command,
                                     const nlohmann::json& arguments, CommandAnswer answer)>;

  LcmDoor(lcm::LCM& lcm, std::vector<NamedKey> keys, Handler handler);
  LcmDoor(const LcmDoor&) = delete;
  LcmDoor& operator=(const LcmDoor&) = delete;
  ~LcmDoor();

  std::uint64_t refused() const { return guard_.refused(); }

 private:
  void receive(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void refuse(const std::string& sender, CommandGuard::Verdict verdict);
  void reply(const std::string& sender, std::int64_t sequence, const Result<nlohmann::json>& answer);

  lcm::LCM& lcm_;
  std::string host_;
  CommandGuard guard_;
  Handler handler_;
  lcm::Subscription* subscription_ = nullptr;
  RateLimit log_limit_{0.2, 5};  ///< a flood of refusals must not flood the log
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< answers may come when the door is gone
};

/// SENDER.key of the directory; those that cannot be used are logged. Empty: the door stays shut.
std::vector<NamedKey> read_keys(const std::string& directory);

/// What `command_v1_t::target` must be.
std::string host_name();

}  // namespace ca2
