#include "foucault/store/shard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "foucault/core/error.h"

namespace foucault::store {
namespace {

using testing::HasSubstr;
using Variables = std::map<std::string, std::string>;

Environment environment(const Variables& variables) {
  return [variables](const std::string& name) -> std::optional<std::string> {
    const auto found = variables.find(name);
    if (found == variables.end()) return std::nullopt;
    return found->second;
  };
}

std::string shard_of(const std::string& text, const Variables& variables = {}) {
  const Shard shard = parse_shard(text, environment(variables));
  return std::to_string(shard.index) + " of " + std::to_string(shard.count);
}

std::string refusal(const std::string& text, const Variables& variables = {}) {
  try {
    parse_shard(text, environment(variables));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(ShardTest, SharesCoverAllOnce) {
  for (const std::size_t size : {0u, 1u, 7u, 100u}) {
    for (const std::size_t count : {1u, 2u, 3u, 8u}) {
      std::size_t next = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const auto [begin, end] = Shard{i, count}.range(size);
        EXPECT_EQ(begin, next);
        EXPECT_LE(end - begin, size / count + 1);
        next = end;
      }
      EXPECT_EQ(next, size);
    }
  }
}

TEST(ShardTest, AsGiven) {
  EXPECT_EQ(shard_of("1/4"), "0 of 4");
  EXPECT_EQ(shard_of("4/4"), "3 of 4");
  for (const char* wrong : {"", "1", "0/4", "5/4", "1/0", "a/4", "1/b", "-1/4", "1/4/2", "auto/",
                            "auto/0", "1/99999999", " 1/4"}) {
    EXPECT_THAT(refusal(wrong), HasSubstr("give i/n")) << wrong;
  }
}

TEST(ShardTest, OfEngines) {
  const Variables array{{"SLURM_ARRAY_TASK_ID", "7"},    {"SLURM_ARRAY_TASK_MIN", "1"},
                        {"SLURM_ARRAY_TASK_COUNT", "4"}, {"SLURM_ARRAY_TASK_STEP", "3"},
                        {"SLURM_PROCID", "0"},           {"SLURM_NTASKS", "9"}};
  EXPECT_EQ(shard_of("auto", array), "2 of 4") << "the script itself is no task of srun";
  EXPECT_EQ(shard_of("auto", {{"OMPI_COMM_WORLD_RANK", "1"}, {"OMPI_COMM_WORLD_SIZE", "2"}}),
            "1 of 2");
  EXPECT_EQ(shard_of("auto", {{"PMI_RANK", "0"}, {"PMI_SIZE", "2"}}), "0 of 2");
  EXPECT_EQ(
      shard_of("auto",
               {{"SLURM_STEP_ID", "0"}, {"SLURM_PROCID", "3"}, {"SLURM_STEP_NUM_TASKS", "4"}}),
      "3 of 4");
  EXPECT_EQ(
      shard_of("auto", {{"AWS_BATCH_JOB_ARRAY_INDEX", "5"}, {"AWS_BATCH_JOB_ARRAY_SIZE", "6"}}),
      "5 of 6");
  EXPECT_EQ(shard_of("auto/6", {{"AWS_BATCH_JOB_ARRAY_INDEX", "5"}}), "5 of 6");
  EXPECT_EQ(shard_of("auto/3", {{"JOB_COMPLETION_INDEX", "2"}}), "2 of 3");
}

TEST(ShardTest, RanksInAnArrayShareItsShares) {
  Variables both{{"SLURM_ARRAY_TASK_ID", "1"},
                 {"SLURM_ARRAY_TASK_MIN", "0"},
                 {"SLURM_ARRAY_TASK_COUNT", "3"},
                 {"OMPI_COMM_WORLD_RANK", "1"},
                 {"OMPI_COMM_WORLD_SIZE", "2"}};
  EXPECT_EQ(shard_of("auto", both), "3 of 6");
}

TEST(ShardTest, WithoutAnEngineItSaysWhatToGive) {
  EXPECT_THAT(refusal("auto"), HasSubstr("--shard i/n"));
  EXPECT_THAT(refusal("auto", {{"JOB_COMPLETION_INDEX", "2"}}), HasSubstr("auto/n"));
  EXPECT_THAT(refusal("auto/4"), HasSubstr("--shard i/4"));
}

}  // namespace
}  // namespace foucault::store
