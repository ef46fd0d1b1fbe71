#include "drivers/published_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "drivers/endpoints.h"

namespace rigwire::drivers {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class PublishedLinkTest : public ::testing::Test {
 protected:
  PublishedLinkTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~PublishedLinkTest() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string refusal() const {
    try {
      const PublishedLink link(path_);
    } catch (const EndpointError& error) {
      return error.what();
    }
    return "no EndpointError";
  }
  /// The exit code of a child that does this.
  static int in_a_child(const std::function<int()>& work) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::_exit(work());
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  fs::path folder_ =
      fs::temp_directory_path() / ("rigwire-link-test-" + std::to_string(::getpid()));
  fs::path path_ = folder_ / "gnss";
  // No terminal of that name: nobody has a thousand of them.
  std::string terminal_ = "/dev/pts/99999";
};

TEST_F(PublishedLinkTest, LeavesNothingBehind) {
  {
    PublishedLink link(path_);
    link.publish(terminal_);
    EXPECT_EQ(fs::read_symlink(path_), terminal_);
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(PublishedLinkTest, AnotherNetworkNamespaceDoesNotTakeAPathThatIsOwned) {
  PublishedLink link(path_);
  link.publish(terminal_);
  constexpr int kNoNamespaces = 77;
  const int result = in_a_child([this] {
    if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) {
      return kNoNamespaces;
    }
    return refusal().find("another running rigwire publishes this path") != std::string::npos ? 0
                                                                                              : 1;
  });
  if (result == kNoNamespaces) {
    GTEST_SKIP() << "this host permits no namespaces";
  }
  EXPECT_EQ(result, 0);
  EXPECT_EQ(fs::read_symlink(path_), terminal_);
}

TEST_F(PublishedLinkTest, ALockThatAKilledOwnerLeftHindersNobody) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    PublishedLink link(path_);
    link.publish(terminal_);
    (void)!::write(ready[1], "x", 1);
    ::pause();
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THAT(refusal(), HasSubstr("another running rigwire"));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(folder_ / ".gnss.lock")) << "the kill should leave the lock's file";
  EXPECT_EQ(refusal(), "no EndpointError");
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_F(PublishedLinkTest, AnOwnerThatEndedWhileAnotherWaitedForItsLockIsNoOwnerAnyMore) {
  {
    const PublishedLink first(path_);
    EXPECT_THAT(refusal(), HasSubstr("another running rigwire"));
  }
  const PublishedLink second(path_);
  EXPECT_THAT(refusal(), HasSubstr("another running rigwire"));
}

TEST_F(PublishedLinkTest, ALinkThatIsInPlaceIsNoNews) {
  PublishedLink link(path_);
  EXPECT_EQ(link.look(), "") << "nothing is published yet";
  link.publish(terminal_);
  EXPECT_EQ(link.look(), "");
}

TEST_F(PublishedLinkTest, ALinkThatWasRemovedIsPutBackAndTold) {
  PublishedLink link(path_);
  link.publish(terminal_);
  fs::remove(path_);
  EXPECT_THAT(link.look(), AllOf(HasSubstr(path_.string()), HasSubstr("it is there again")));
  EXPECT_EQ(fs::read_symlink(path_), terminal_);
  EXPECT_EQ(link.look(), "");
}

TEST_F(PublishedLinkTest, ALinkIsPutBackWhenItsWholeFolderWasRemovedAndStaysOwned) {
  PublishedLink link(path_);
  link.publish(terminal_);
  fs::remove_all(folder_);
  EXPECT_THAT(link.look(), HasSubstr("it is there again"));
  EXPECT_EQ(fs::read_symlink(path_), terminal_);
  EXPECT_THAT(refusal(), HasSubstr("another running rigwire"));
}

TEST_F(PublishedLinkTest, ALeftoverInItsPlaceIsReplaced) {
  PublishedLink link(path_);
  link.publish(terminal_);
  fs::remove(path_);
  fs::create_symlink("/dev/pts/99998", path_);
  EXPECT_THAT(link.look(), HasSubstr("it is there again"));
  EXPECT_EQ(fs::read_symlink(path_), terminal_);
}

TEST_F(PublishedLinkTest, AFileInItsPlaceIsToldOnceAndStays) {
  PublishedLink link(path_);
  link.publish(terminal_);
  fs::remove(path_);
  std::ofstream(path_) << "precious";
  EXPECT_THAT(link.look(), AllOf(HasSubstr("a file is there"), HasSubstr(terminal_)));
  EXPECT_EQ(link.look(), "");
  std::string content;
  std::ifstream(path_) >> content;
  EXPECT_EQ(content, "precious");
  fs::remove(path_);
  EXPECT_THAT(link.look(), HasSubstr("it is there again"));
}

TEST_F(PublishedLinkTest, ALinkOfSomebodyElsesInItsPlaceStaysToTheEnd) {
  {
    PublishedLink link(path_);
    link.publish(terminal_);
    fs::remove(path_);
    fs::create_symlink("/dev/null", path_);
    EXPECT_THAT(link.look(), HasSubstr("which is no pseudo-terminal"));
  }
  EXPECT_EQ(fs::read_symlink(path_), "/dev/null");
}

TEST_F(PublishedLinkTest, ANameThatSomebodyElseOwnsMeanwhileIsLeftToHim) {
  PublishedLink link(path_);
  link.publish(terminal_);
  fs::remove_all(folder_);
  const PublishedLink other(path_);
  EXPECT_THAT(link.look(), HasSubstr("not ours any more"));
  EXPECT_FALSE(fs::exists(fs::symlink_status(path_)));
}

TEST_F(PublishedLinkTest, AnotherUsersLockCanBeTakenWhenItIsFree) {
  if (::geteuid() != 0) {
    GTEST_SKIP() << "only root makes files of two users";
  }
  std::ofstream(folder_ / ".gnss.lock") << "";  // root's, as a killed run leaves it
  fs::permissions(folder_, fs::perms::all | fs::perms::sticky_bit);
  EXPECT_EQ(in_a_child([this] {
              constexpr uid_t kNobody = 65534;
              if (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0) {
                return 2;
              }
              return refusal() == "no EndpointError" ? 0 : 1;
            }),
            0);
}

}  // namespace
}  // namespace rigwire::drivers
