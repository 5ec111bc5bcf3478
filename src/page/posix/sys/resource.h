struct rusage {
    long ru_maxrss;
};
#define RUSAGE_SELF           0
#define getrusage(who, usage) ((void)(who), (usage)->ru_maxrss = 0, 0)
