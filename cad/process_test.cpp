// A program's answer arrives whole whatever its size; each way to end badly is told, by small
// shell programs in place of batten-cad.
#include "process.hpp"

#include "message.hpp"
#include "test_folder.hpp"

#include <batten/core/core.hpp>

#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace batten::cad {
namespace {

/// A shell program that runs `commands`.
std::filesystem::path program(const std::string& name, const std::string& commands) {
    const std::filesystem::path path = in_test_folder(name);
    std::ofstream(path) << "#!/bin/sh\n" << commands << '\n';
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
}

std::string failure(const std::filesystem::path& path, std::string_view request = "x") {
    try {
        answer_of(path, request, {});
    } catch (const Failed& failed) {
        return failed.what();
    }
    return "none";
}

TEST(CadProcess, large_requests_and_answers_pass) {
    std::string request(20'000'000, 'a'); // beyond what any line holds at once
    request.back() = 'z';
    EXPECT_TRUE(answer_of(program("echo", "exec cat >&0"), request, {}) == request);
}

TEST(CadProcess, bad_ends_are_told) {
    EXPECT_EQ(failure(program("crash", "kill -SEGV $$")), "signal 11: Segmentation fault");
    EXPECT_EQ(failure(program("abort", "cat >/dev/null; echo half >&0; kill -ABRT $$")),
              "signal 6: Aborted");
    EXPECT_EQ(failure(program("endless", "kill -XCPU $$")),
              "it came to no end in the processor time allowed");
    EXPECT_EQ(failure(program("status", "exit 7")), "batten-cad ended with status 7");
    // one that leaves before it has heard all
    EXPECT_EQ(failure(program("deaf", "exit 7"), std::string(20'000'000, 'a')),
              "batten-cad ended with status 7");
    EXPECT_EQ(failure("/none/batten-cad"),
              "/none/batten-cad cannot be started: No such file or directory");
}

TEST(CadProcess, nothing_of_the_caller_is_inherited) {
    const int kept = fcntl(STDIN_FILENO, F_DUPFD, 77); // without FD_CLOEXEC
    ASSERT_GE(kept, 77);
    const std::string files =
        answer_of(program("files", "cat >/dev/null; exec >&0; ls /proc/$$/fd"), "x", {});
    close(kept);
    EXPECT_TRUE(files.starts_with("0\n1\n")) << files;
    EXPECT_EQ(files.find(fmt::format("{}\n", kept)), std::string::npos) << files;
    EXPECT_EQ(answer_of(program("caller", "cat >/dev/null; printf %s $1 >&0"), "x", {}),
              std::to_string(getpid()));
}

TEST(CadProcess, cancelled_work_is_ended) {
    const std::filesystem::path path =
        program("sleeper", "cat >/dev/null; echo $$ >&0; sleep 1000");
    int asked = 0;
    EXPECT_THROW(answer_of(path, "x", [&] { return ++asked > 3; }), Cancelled);
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1); // no process is left
}

TEST(CadProcess, callers_may_ignore_ended_processes) {
    const auto before = std::signal(SIGCHLD, SIG_IGN);
    EXPECT_EQ(answer_of(program("echo", "exec cat >&0"), "abc", {}), "abc");
    std::signal(SIGCHLD, before);
}

TEST(CadProcess, threads_do_not_mix) {
    const std::filesystem::path path = program("echo", "exec cat >&0");
    std::vector<std::thread> threads;
    std::vector<std::string> answers(8);
    for (std::size_t k = 0; k < answers.size(); ++k)
        threads.emplace_back([&, k] {
            answers[k] = answer_of(path, std::string(300'000, static_cast<char>('a' + k)), {});
        });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t k = 0; k < answers.size(); ++k)
        EXPECT_TRUE(answers[k] == std::string(300'000, static_cast<char>('a' + k))) << k;
}

} // namespace
} // namespace batten::cad
