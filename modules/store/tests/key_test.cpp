#include "foucault/store/key.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "foucault/core/error.h"
#include "foucault/store/file_hash.h"
#include "support/test_folder.h"

namespace foucault::store {
namespace {

/// Of FIPS 180-4 and of `sha256sum`.
TEST(Key, IsTheSha256) {
  EXPECT_EQ(hex(key_of("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hex(key_of("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hex(key_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hex(key_of(std::string(1'000'000, 'a'))),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Key, DoesNotDependOnThePieces) {
  const std::string text(300, 'x');
  for (const std::size_t piece : {1u, 7u, 63u, 64u, 65u, 200u}) {
    Sha256 hash;
    for (std::size_t at = 0; at < text.size(); at += piece) hash.add(text.substr(at, piece));
    EXPECT_EQ(hash.finish(), key_of(text)) << piece;
  }
}

TEST(FileHash, OfTheContent) {
  const test::TestFolder folder;
  folder.write("a", "abc");
  folder.write("b", "abc");
  EXPECT_EQ(hash_file(folder / "a"), key_of("abc"));
  EXPECT_NE(file_stamp(folder / "a"), file_stamp(folder / "b"));
  EXPECT_THROW(hash_file(folder / "none"), DataError);
  EXPECT_THROW(hash_file(folder.path()), DataError);
}

TEST(FileHash, StampsTellWhatChangedAtTheSameSize) {
  const test::TestFolder folder;
  folder.write("a", "abc");
  hash_file(folder / "a");
  const std::string before = file_stamp(folder / "a");
  EXPECT_EQ(file_stamp(folder / "a"), before);
  folder.write("a", "abd");
  EXPECT_NE(file_stamp(folder / "a"), before);
}

}  // namespace
}  // namespace foucault::store
