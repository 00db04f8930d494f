#include <batten/io/staged_names.hpp>

#include <atomic>
#include <unistd.h>

namespace batten {

/// A place in the list of names. Places stay for ever and are used again, so that a handler may
/// walk the list at any time; whoever takes a name out by exchange has it alone.
struct StagedName::Entry {
    std::atomic<const char*> name{nullptr};
    Entry* next = nullptr;

    static std::atomic<Entry*> first;
};

std::atomic<StagedName::Entry*> StagedName::Entry::first{nullptr};

StagedName::StagedName(std::filesystem::path path) : path_(std::move(path)), entry_(nullptr) {
    for (Entry* entry = Entry::first; entry != nullptr; entry = entry->next) {
        const char* none = nullptr;
        if (!entry->name.compare_exchange_strong(none, path_.c_str())) continue;
        entry_ = entry;
        return;
    }
    entry_ = new Entry;
    entry_->name = path_.c_str();
    entry_->next = Entry::first;
    while (!Entry::first.compare_exchange_weak(entry_->next, entry_)) {
    }
}

StagedName::~StagedName() {
    entry_->name = nullptr;
}

void remove_staged_files() noexcept {
    for (StagedName::Entry* entry = StagedName::Entry::first; entry != nullptr; entry = entry->next)
        if (const char* name = entry->name.exchange(nullptr)) ::unlink(name);
}

SignalsHeld::SignalsHeld() {
    sigset_t all;
    sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &before_);
}

SignalsHeld::~SignalsHeld() {
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

} // namespace batten
