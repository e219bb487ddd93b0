#include "drivers/survey/recogniser.h"

namespace ca2 {
namespace {

class Unknown : public Recogniser {
 public:
  void add(std::span<const std::uint8_t>, std::int64_t) override {}
  StreamIdentity identity() const override { return {"", "", "unknown", {}, std::nullopt}; }
};

}  // namespace

std::unique_ptr<Recogniser> make_recogniser(std::span<const std::uint8_t> payload) {
  if (auto velodyne = make_velodyne_recogniser(payload)) return velodyne;
  if (auto ouster = make_ouster_recogniser(payload)) return ouster;
  return std::make_unique<Unknown>();
}

}  // namespace ca2
