#include "foucault/simulation/random.h"

namespace foucault::simulation {
namespace {

std::mt19937_64 engine_of(int64_t seed, RandomStream stream) {
  const uint64_t bits = static_cast<uint64_t>(seed);
  std::seed_seq sequence{static_cast<uint32_t>(bits), static_cast<uint32_t>(bits >> 32),
                         static_cast<uint32_t>(stream)};
  return std::mt19937_64(sequence);
}

}  // namespace

Draws::Draws(int64_t seed, RandomStream stream) : engine_(engine_of(seed, stream)) {}

Eigen::Vector3d Draws::normal3() {
  const double x = normal();
  const double y = normal();
  const double z = normal();
  return {x, y, z};
}

double Draws::uniform(double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(engine_);
}

}  // namespace foucault::simulation
